//! Content of the live view: contact force over time, the journal's orbit in its clearance, the
//! flags.

use crate::impact_text;
use controller::flags::NAMES;
use inference::Flags;
use link::{EstimateFrame, ImpactRecord, SensorFrame};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::canvas::{Canvas, Circle, Points};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

/// Maximum number of points of a curve: twice the columns of a wide terminal.
const POINTS: usize = 800;
/// Maximum number of points of the orbit.
const TRAIL: usize = 400;

/// The run so far.
#[derive(Clone, Debug)]
pub struct Scene {
    title: String,
    duration_s: f64,
    clearance_um: f64,
    /// The bench's own force over time, s and kN.
    truth: Vec<(f64, f64)>,
    estimate: Vec<(f64, f64)>,
    trail: Vec<(f64, f64)>,
    samples: u32,
    last: EstimateFrame,
    time_s: f64,
    peak_kn: f64,
    /// Number of samples with each flag, in the order of their names.
    flagged: [u32; NAMES.len()],
    /// Peaks of the recorded impacts, s and kN.
    impacts: Vec<(f64, f64)>,
    last_impact: Option<ImpactRecord>,
}

impl Scene {
    /// Creates the view of a run of `duration_s`, with the bench's own contact force over time in s
    /// and N.
    pub fn new(
        title: String,
        duration_s: f64,
        clearance_m: f64,
        truth: impl Iterator<Item = (f64, f64)>,
    ) -> Self {
        let truth: Vec<_> = truth.map(|(time_s, force_n)| (time_s, force_n * 1e-3)).collect();
        let thinned = truth.iter().step_by((truth.len() / POINTS).max(1)).copied().collect();
        Self {
            title,
            duration_s,
            clearance_um: clearance_m * 1e6,
            peak_kn: truth.iter().fold(0.0, |peak, (_, force)| peak.max(*force)),
            truth: thinned,
            estimate: Vec::new(),
            trail: Vec::new(),
            samples: 0,
            last: EstimateFrame::default(),
            time_s: 0.0,
            flagged: [0; NAMES.len()],
            impacts: Vec::new(),
            last_impact: None,
        }
    }

    /// Takes the impacts that have ended.
    pub(crate) fn add_impacts(&mut self, ended: &[ImpactRecord]) {
        for impact in ended {
            self.impacts.push((f64::from(impact.peak_us) * 1e-6, f64::from(impact.peak_force_n) * 1e-3));
            self.last_impact = Some(*impact);
        }
    }

    /// Takes a sample and its estimate.
    pub fn observe(&mut self, sample: &SensorFrame, estimate: &EstimateFrame) {
        self.time_s = f64::from(sample.time_us) * 1e-6;
        self.samples = self.samples.saturating_add(1);
        let force_kn = f64::from(estimate.normal_force_n) * 1e-3;
        self.peak_kn = self.peak_kn.max(force_kn);
        let apart_s = self.duration_s / POINTS as f64;
        if self.estimate.last().is_none_or(|(time_s, _)| self.time_s - time_s >= apart_s) {
            self.estimate.push((self.time_s, force_kn));
            if self.trail.len() >= TRAIL {
                self.trail.remove(0);
            }
            self.trail.push((f64::from(sample.journal_y_nm) * 1e-3, f64::from(sample.journal_z_nm) * 1e-3));
        }
        let flags = Flags::from_bits(estimate.flags);
        for (count, (flag, _)) in self.flagged.iter_mut().zip(NAMES) {
            *count = count.saturating_add(u32::from(flags.intersects(flag)));
        }
        self.last = *estimate;
    }

    /// Draws the view.
    pub fn draw(&self, frame: &mut Frame<'_>) {
        let heights =
            [Constraint::Length(1), Constraint::Min(8), Constraint::Length(3), Constraint::Length(4)];
        let [head, body, impacts, footer] = Layout::vertical(heights).areas(frame.area());
        // A terminal cell is twice as high as wide, so this area is square.
        let square = (2 * body.height).min(body.width / 2);
        let [force, orbit] =
            Layout::horizontal([Constraint::Min(20), Constraint::Length(square)]).areas(body);
        frame.render_widget(self.head(), head);
        self.force(frame, force);
        self.orbit(frame, orbit);
        frame.render_widget(self.impacts(), impacts);
        frame.render_widget(self.footer(), footer);
    }

    /// Number of impacts, the largest peak and the last impact.
    fn impacts(&self) -> Paragraph<'_> {
        let largest_n = self.impacts.iter().fold(0.0_f64, |largest, (_, peak)| largest.max(1e3 * peak));
        let text = self.last_impact.as_ref().map_or_else(|| "none so far".into(), impact_text::line);
        let title = match self.impacts.len() {
            0 => "impacts".into(),
            count => format!("{count} impacts, largest peak {largest_n:.0} N; the last one"),
        };
        Paragraph::new(text).block(Block::bordered().title(title))
    }

    fn head(&self) -> Line<'_> {
        let e = &self.last;
        Line::from(vec![
            self.title.as_str().bold(),
            format!("   {:8.4} s of {:.2} s", self.time_s, self.duration_s).into(),
            format!("   {:7.0} N", e.normal_force_n).fg(Color::Cyan).bold(),
            format!("   {:+7.1} N m   {:+6.1} um", e.friction_torque_nm, e.deformation_m * 1e6).into(),
            "   q: close".dim(),
        ])
    }

    fn force(&self, frame: &mut Frame<'_>, area: Rect) {
        let curve = |name: &'static str, color: Color, points| {
            let line = Dataset::default().name(name).data(points).style(Style::new().fg(color));
            line.marker(Marker::Braille).graph_type(GraphType::Line)
        };
        let top = (self.peak_kn * 1.1).max(1e-3);
        let labels = |most: f64| [0.0, 0.5 * most, most].map(|value| Span::from(format!("{value:.2}")));
        let chart = Chart::new(vec![
            curve("bench", Color::DarkGray, &self.truth),
            curve("estimate", Color::Cyan, &self.estimate),
            curve("impacts", Color::Yellow, &self.impacts).marker(Marker::Dot).graph_type(GraphType::Scatter),
        ])
        .block(Block::bordered().title("contact force, kN, over time, s"))
        .x_axis(Axis::default().bounds([0.0, self.duration_s]).labels(labels(self.duration_s)))
        .y_axis(Axis::default().bounds([0.0, top]).labels(labels(top)));
        frame.render_widget(chart, area);
    }

    fn orbit(&self, frame: &mut Frame<'_>, area: Rect) {
        let reach = 1.25 * self.clearance_um.max(1e-3);
        let canvas = Canvas::default()
            .block(Block::bordered().title("journal, um"))
            .marker(Marker::Braille)
            .x_bounds([-reach, reach])
            .y_bounds([-reach, reach])
            .paint(|context| {
                context.draw(&Circle { x: 0.0, y: 0.0, radius: self.clearance_um, color: Color::DarkGray });
                context.layer();
                context.draw(&Points { coords: &self.trail, color: Color::Cyan });
                if let Some(&(y, z)) = self.trail.last() {
                    context.print(y, z, "o".yellow().bold());
                }
            });
        frame.render_widget(canvas, area);
    }

    /// Flags of the last estimate, bright, and of earlier ones, with the number of samples.
    fn footer(&self) -> Paragraph<'_> {
        let now = Flags::from_bits(self.last.flags);
        let mut words: Vec<Span<'_>> = Vec::new();
        for ((flag, name), count) in NAMES.iter().zip(self.flagged).filter(|(_, count)| *count > 0) {
            let word = format!("{name} {count}  ");
            words.push(if now.intersects(*flag) { word.fg(Color::Red).bold() } else { word.dim() });
        }
        if words.is_empty() {
            words.push("none so far".fg(Color::Green));
        }
        let title = format!("flags over {} samples", self.samples);
        Paragraph::new(Line::from(words))
            .wrap(ratatui::widgets::Wrap { trim: true })
            .block(Block::bordered().title(title))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller::flags::{HELD, JUMP};
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    fn shown(scene: &Scene, size: (u16, u16)) -> String {
        let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).unwrap();
        terminal.draw(|frame| scene.draw(frame)).unwrap();
        terminal.backend().to_string()
    }

    fn scene() -> Scene {
        let truth = (0..100).map(|i| (f64::from(i) * 0.01, 100.0 * f64::from(i)));
        Scene::new("bench B".into(), 1.0, 5e-4, truth)
    }

    fn run(scene: &mut Scene, samples: u32, flags: u32) {
        for index in 0..samples {
            let angle = f64::from(index) / f64::from(samples) * core::f64::consts::TAU;
            let sample = SensorFrame {
                sequence: index,
                time_us: (f64::from(index) / f64::from(samples) * 1e6) as u32,
                journal_y_nm: (400_000.0 * angle.cos()) as i32,
                journal_z_nm: (400_000.0 * angle.sin()) as i32,
                ..SensorFrame::default()
            };
            let estimate =
                EstimateFrame { normal_force_n: 0.3 * index as f32, flags, ..EstimateFrame::default() };
            scene.observe(&sample, &estimate);
        }
    }

    #[test]
    fn force_orbit_and_flags_are_there() {
        let mut scene = scene();
        let empty = shown(&scene, (120, 40));
        assert!(
            empty.contains("contact force") && empty.contains("journal, um") && empty.contains("none so far")
        );
        run(&mut scene, 10_000, 0);
        run(&mut scene, 3, (JUMP | HELD).bits());
        let full = shown(&scene, (120, 40));
        assert!(full.contains("jump 3") && full.contains("held 3") && !full.contains("stuck"), "{full}");
        let dots = |text: &str| text.chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count();
        assert!(dots(&full) > dots(&empty) + 50, "the estimate and the orbit have left a trail:\n{full}");
        assert!(scene.estimate.len() <= POINTS + 1 && scene.trail.len() <= TRAIL);
    }

    #[test]
    fn impacts_are_counted_and_the_last_one_is_described() {
        let mut scene = scene();
        assert!(shown(&scene, (120, 40)).contains("none so far"));
        let impact = |number, peak_force_n| ImpactRecord {
            number,
            peak_us: 300_000,
            peak_force_n,
            ..ImpactRecord::default()
        };
        scene.add_impacts(&[impact(0, 5_000.0), impact(1, 700.0)]);
        let text = shown(&scene, (120, 40));
        assert!(text.contains("2 impacts, largest peak 5000 N") && text.contains("impact 1 at"), "{text}");
    }

    #[test]
    fn any_terminal_will_do() {
        let mut scene = scene();
        run(&mut scene, 1000, JUMP.bits());
        for size in [(1, 1), (3, 2), (20, 8), (80, 24), (300, 100)] {
            shown(&scene, size);
        }
    }
}
