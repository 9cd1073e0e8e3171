//! Fig. 2: forces in a revolute joint with clearance.

use crate::cli::output::Picture;

/// The drawing: bearing, journal in contact, centre distance, deformation and the forces on the
/// journal. Black, blue and orange are colours that a page replaces in a dark scheme.
const SVG: &str = r##"<svg width="512" height="380" viewBox="0 0 512 380" xmlns="http://www.w3.org/2000/svg">
<rect x="0" y="0" width="512" height="380" fill="#FFFFFF" stroke="none"/>
<defs>
<marker id="tip-black" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto">
<path d="M0 0L8 4L0 8Z" fill="#000000"/>
</marker>
<marker id="tip-blue" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto">
<path d="M0 0L8 4L0 8Z" fill="#0072B2"/>
</marker>
<marker id="tip-orange" markerWidth="8" markerHeight="8" refX="7" refY="4" orient="auto">
<path d="M0 0L8 4L0 8Z" fill="#D55E00"/>
</marker>
</defs>
<g font-family="sans-serif" font-size="14" stroke-width="1.5">
<circle cx="200" cy="190" r="150" fill="none" stroke="#000000" stroke-width="3"/>
<circle cx="240" cy="220" r="106" fill="none" stroke="#0072B2" stroke-width="3"/>
<circle cx="200" cy="190" r="3" fill="#000000" stroke="none"/>
<circle cx="240" cy="220" r="3" fill="#0072B2" stroke="none"/>
<line x1="200" y1="190" x2="240" y2="220" stroke="#000000"/>
<line x1="240" y1="220" x2="324.8" y2="283.6" stroke="#0072B2" stroke-dasharray="5 4"/>
<line x1="324.8" y1="283.6" x2="268" y2="241" stroke="#D55E00" stroke-width="3"
  marker-end="url(#tip-orange)"/>
<line x1="324.8" y1="283.6" x2="366.8" y2="227.6" stroke="#0072B2" stroke-width="3"
  marker-end="url(#tip-blue)"/>
<path d="M 168 262 A 78 78 0 0 0 300 270" fill="none" stroke="#0072B2" marker-end="url(#tip-blue)"/>
<line x1="324.8" y1="283.6" x2="392" y2="334" stroke="#000000" marker-end="url(#tip-black)"/>
<text x="176" y="184" fill="#000000">O_B</text>
<text x="222" y="244" fill="#0072B2">O_J</text>
<text x="222" y="200" fill="#000000">a</text>
<text x="268" y="232" fill="#D55E00">F_n</text>
<text x="372" y="224" fill="#0072B2">F_f t</text>
<text x="398" y="338" fill="#000000">n</text>
<text x="204" y="312" fill="#0072B2">turning</text>
<text x="196" y="32" fill="#000000">bearing, R_B</text>
<text x="216" y="104" fill="#0072B2">journal, R_J</text>
<text x="372" y="150" fill="#000000">clearance</text>
<text x="372" y="168" fill="#000000">D = R_B - R_J</text>
<text x="372" y="286" fill="#000000">deformation</text>
<text x="372" y="304" fill="#000000">d = a - D &gt; 0</text>
</g>
</svg>"##;

/// Fig. 2 as a picture.
pub(in crate::reproduction) fn forces() -> Picture {
    let caption = "Fig. 2: journal in contact with the bearing. The normal force acts against n, the \
                   friction force along t against the sliding. Clearance and deformation are enlarged.";
    Picture { name: "force-diagram".into(), caption: caption.into(), drawing: String::from(SVG).into() }
}
