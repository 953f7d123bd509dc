//! Drawings as a whole; what each part of them means is tested where it is read.

use super::namespaces::XLINK;
use super::*;

pub(super) fn scene(inside: &str) -> Result<Scene, String> {
    let start = format!("<svg xmlns='{SVG}' xmlns:xlink='{XLINK}' xmlns:inkscape='{INKSCAPE}' viewBox='0 0 100 50'>\n");
    parse(&format!("{start}{inside}</svg>"), Some(0.1)).map_err(|fault| format!("{}: {}", fault.place, fault.what))
}

pub(super) fn walls(inside: &str) -> Vec<[f64; 4]> {
    let scene = scene(inside).unwrap_or_else(|what| panic!("{inside}: {what}"));
    (0..scene.walls().len()).map(|w| scene.ends(w)).map(|[a, b]| [a.x, a.y, b.x, b.y]).collect()
}

const LINE: &str = "<line x1='1' y1='2' x2='3' y2='5'/>";

#[test]
fn groups_uses_and_transforms_add_up() {
    let line = [1., 2., 3., 5.];
    let moved = [11., 22., 13., 25.];
    assert_eq!(walls(&format!("<g>{LINE}</g><a>{LINE}</a>")), [line, line]);
    assert_eq!(walls(&format!("<g transform='translate(10,20)'>{LINE}</g>")), [moved]);
    let nested = format!("<g transform='translate(10)'><g transform='scale(2) translate(0,10)'>{LINE}</g></g>");
    assert_eq!(walls(&nested), [[12., 24., 16., 30.]]);
    let defs = format!("<defs><g id='a'>{LINE}</g></defs>");
    assert_eq!(walls(&format!("{defs}<use xlink:href='#a' x='10' y='20'/><use href='#a'/>")), [moved, line]);
    let twice = format!("{defs}<path id='a' d='M0,0'/><use href='#a'/>");
    assert_eq!(walls(&twice), [line]);
    let quarter = "<use href='#a' transform='rotate(90)' x='1'/>";
    assert_eq!(walls(&format!("{defs}{quarter}")), [[-2., 2., -5., 4.]]);
    let symbol = format!("<symbol id='s' viewBox='0 0 10 10'>{LINE}</symbol>");
    assert_eq!(walls(&format!("{symbol}<use href='#s' width='20' height='20' x='1'/>")), [[3., 4., 7., 10.]]);
    assert_eq!(walls(&format!("<svg x='10' y='20'>{LINE}</svg>")), [moved]);
    let fitted = format!("<svg width='20' height='10' viewBox='0 0 10 10'>{LINE}</svg>");
    assert_eq!(walls(&fitted), [[6., 2., 8., 5.]]);
    let switch = format!("<switch><foreignObject requiredExtensions='x'/><g>{LINE}</g>{LINE}</switch>");
    assert_eq!(walls(&switch), [line]);
}

#[test]
fn what_is_hidden_or_no_shape_is_told_of() {
    let hidden = format!("<g style='display:none'>{LINE}{LINE}</g><g visibility='hidden'>{LINE}</g>");
    let shown = "<g visibility='hidden'><path visibility='visible' d='M0,0h1'/></g>";
    let others = "<text>a</text><image/><text>b</text><flowRoot/><metadata/><inkscape:grid/><title/>";
    let cut = "<path clip-path='url(#c)' d='M0,0h2'/><g mask='url(#m)'/>";
    let clip = "<clipPath id='c'><path d='M0,0h9'/></clipPath><pattern><path d='M0,0h9'/></pattern>";
    let scene = scene(&format!("{hidden}{shown}{others}{cut}{clip}")).unwrap();
    assert_eq!(scene.walls().len(), 2);
    let expected = [
        "units are those of the viewBox; y points down, as in the file",
        "hidden elements, which are no walls: 2",
        "clip paths and masks cut no walls; elements taken whole: 2",
        "passed over: 1 flowRoot, 1 image, 2 text",
    ];
    assert_eq!(scene.notes(), expected);
}

#[test]
fn style_sheets_hide_layers() {
    let style = "<style>.st0{display:none;} .st1{fill:none;stroke:#000;}</style>";
    assert_eq!(walls(&format!("{style}<g class='st0'>{LINE}</g><g class='st1'>{LINE}</g>")).len(), 1);
}

#[test]
fn the_element_called_anchor_marks_it_and_is_no_wall() {
    let anchor = |inside: &str| {
        let scene = scene(&format!("{LINE}{inside}")).unwrap();
        assert_eq!(scene.walls().len(), 1, "{inside}");
        scene.anchor().map(|p| p.to_array())
    };
    assert_eq!(anchor(""), None);
    assert_eq!(anchor("<circle id='anchor' cx='0.1' cy='7' r='0.3'/>"), Some([0.1, 7.0]));
    assert_eq!(anchor("<circle id='anchor' cx='0.1' cy='7'/>"), Some([0.1, 7.0]));
    let moved = "<g transform='translate(10)'><ellipse id='anchor' cy='7' rx='3' ry='1' transform='scale(2)'/></g>";
    assert_eq!(anchor(moved), Some([10.0, 14.0]));
    assert_eq!(anchor("<rect id='anchor' x='4' y='6' width='2' height='1'/>"), Some([5.0, 6.5]));
    assert_eq!(anchor("<path inkscape:label='anchor' id='path7' d='M4,6 h2 v1 z'/>"), Some([5.0, 6.5]));
    assert_eq!(anchor("<g inkscape:label='anchor'><path id='anchor' d='M4,6 h2 v1'/></g>"), Some([5.0, 6.5]));
    assert_eq!(anchor("<defs><circle id='anchor' r='1'/></defs>"), None);
    assert_eq!(anchor("<circle id='anchor' r='1' display='none'/>"), None);
}

#[test]
fn units_are_told() {
    let unit = |attributes: &str| {
        let scene = parse(&format!("<svg xmlns='{SVG}' {attributes}><path d='M1,2h3'/></svg>"), None).unwrap();
        assert_eq!(scene.ends(0).map(|p| p.to_array()), [[1.0, 2.0], [4.0, 2.0]], "{attributes}");
        scene.notes()[0].clone()
    };
    let y = "; y points down, as in the file";
    assert_eq!(unit(""), format!("a unit is a pixel, of which 96 are an inch{y}"));
    assert_eq!(unit("width='50%' viewBox='0 0 9 9'"), format!("units are those of the viewBox{y}"));
    let mm = "a unit is 1 mm (the drawing is 210 mm wide, its viewBox 210)";
    assert_eq!(unit("width='210mm' height='297mm' viewBox='0 0 210 297'"), format!("{mm}{y}"));
    let px = "a unit is 0.264583 mm (the drawing is 210 mm wide, its viewBox 793.701)";
    assert_eq!(unit("width='210mm' viewBox='7 7 793.701 1122.52'"), format!("{px}{y}"));
}

#[test]
fn percentages_are_of_the_view_box() {
    assert_eq!(walls("<line x2='50%' y2='50%'/>"), [[0., 0., 50., 25.]]);
}

#[test]
fn faults_name_line_and_element() {
    for (inside, expected) in [
        ("<g>\n<path id='p' d='M1,2 L3'/></g>", "line 3: <path id=\"p\">: d: "),
        ("<rect width='-1' height='2'/>", "line 2: <rect>: width is -1; it must not be negative"),
        ("<path d='M1e200,0h1'/>", "line 2: <path>: d: 1e200 is too large for exact products"),
        ("<path d='M1e-200,0h1'/>", "line 2: <path>: d: 1e-200 is too small for exact products"),
        ("<g transform='scale(1e200)'><path d='M9,0h1'/></g>", "line 2: <path>: d: 9e200 is too large"),
        ("<g transform='turn(9)'/>", "line 2: <g>: transform: "),
        ("<use id='u'/>", "line 2: <use id=\"u\">: names nothing to use; it needs href=\"#id\""),
        ("<use href='a.svg#b'/>", "line 2: <use>: uses \"a.svg#b\" of another file"),
        ("<use href='#b'/>", "line 2: <use>: uses the element \"b\", which the file does not have"),
        ("<g id='a'><use href='#a'/></g>", "lie in or use each other more than 128 deep"),
        ("<symbol id='a'><use href='#a'/></symbol><use href='#a'/>", "lie in or use each other more than 128 deep"),
        ("<text id='anchor'>x</text>", "line 2: <text id=\"anchor\">: marks the anchor but draws nothing"),
        (
            "<path id='anchor' d='M0,0h1'/>\n<circle id='anchor' r='1'/>",
            "line 3: <circle id=\"anchor\">: a second anchor; that of line 2 marks one already",
        ),
        ("<svg viewBox='0 0 0 1'/>", "line 2: <svg>: viewBox"),
        ("<path>", "line 2, column "),
        ("&what;", "line 2, column 1: not SVG: "),
    ] {
        let what = scene(inside).unwrap_err();
        assert!(what.contains(expected), "{inside}: {what}");
    }
    let fault = |text: &str| parse(text, None).unwrap_err().what;
    assert_eq!(fault("<html/>"), "<html>: not SVG: the outermost element is <html>, not <svg>");
    assert!(fault("").starts_with("not SVG: "));
}

#[test]
fn drawings_that_blow_up_are_refused() {
    // Each of 30 groups uses the one before twice: a billion lines of a kilobyte.
    let mut laughs = format!("<defs><g id='g0'>{LINE}</g>");
    for i in 1..30 {
        laughs += &format!("<g id='g{i}'><use href='#g{0}'/><use href='#g{0}'/></g>", i - 1);
    }
    let what = scene(&format!("{laughs}</defs><use href='#g29'/>")).unwrap_err();
    assert!(what.contains("with all that is used again and again, the drawing is too large"), "{what}");

    let mut entities = String::from("<!DOCTYPE svg [<!ENTITY a0 \"<path d='M0,0h1'/>\">");
    for i in 1..30 {
        entities += &format!("<!ENTITY a{i} \"&a{0};&a{0};&a{0};&a{0};\">", i - 1);
    }
    let text = format!("{entities}]><svg xmlns='{SVG}'>&a29;</svg>");
    assert!(parse(&text, None).unwrap_err().what.contains("written out, are too long for a drawing"));

    let deep = "<g>".repeat(200_000) + &"</g>".repeat(200_000);
    let what = scene(&deep).unwrap_err();
    assert!(what.contains("more than 128 deep") || what.contains("not SVG"), "{what}");
}

#[test]
fn doctypes_and_drawings_without_a_namespace_are_read() {
    let doctype = "<?xml version='1.0'?><!DOCTYPE svg PUBLIC '-//W3C//DTD SVG 1.1//EN' 'x.dtd' [<!ENTITY ns 'y'>]>";
    let text = format!("{doctype}<svg xmlns='{SVG}' xmlns:x='&ns;'>{LINE}</svg>");
    assert_eq!(parse(&text, None).unwrap().walls().len(), 1);
    assert_eq!(parse(&format!("<svg>{LINE}</svg>"), None).unwrap().walls().len(), 1);
}
