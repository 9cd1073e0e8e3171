// Plays the sketches of a page: bodies move, forces are arrows, a slider chooses the time.
"use strict";
(() => {
  /// Milliseconds of a whole run.
  const PLAY_MS = 8000;

  function animate(figure) {
    const { times, bodies, forces } = JSON.parse(figure.dataset.frames);
    const all = (selector) => [...figure.querySelectorAll(selector)];
    const [drawnBodies, arrows] = [all("[data-body]"), all("[data-force]")];
    const [button, slider, time] = ["button", "input", "output"].map((name) => figure.querySelector(name));
    let [frame, isPlaying, last] = [0, false, 0];

    function draw() {
      bodies[frame].forEach(([x, y, angle], i) => {
        drawnBodies[i].setAttribute("transform", `translate(${x} ${y}) rotate(${angle})`);
      });
      forces[frame].forEach((ends, i) => {
        ["x1", "y1", "x2", "y2"].forEach((name, k) => arrows[i].setAttribute(name, ends[k]));
        arrows[i].style.display = ends[0] === ends[2] && ends[1] === ends[3] ? "none" : "";
      });
      slider.value = frame;
      time.textContent = `${times[frame].toPrecision(4)} s`;
    }
    function step(now) {
      if (!isPlaying) return;
      if (now - last >= PLAY_MS / times.length) {
        last = now;
        frame = (frame + 1) % times.length;
        draw();
      }
      requestAnimationFrame(step);
    }
    function play(is) {
      isPlaying = is;
      button.textContent = is ? "Pause" : "Play";
      if (is) requestAnimationFrame(step);
    }
    slider.max = times.length - 1;
    button.onclick = () => play(!isPlaying);
    slider.oninput = () => {
      play(false);
      frame = Number(slider.value);
      draw();
    };
    figure.querySelector(".controls").hidden = false;
    draw();
    play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  document.querySelectorAll("figure[data-frames]").forEach(animate);
})();
