//! What drawings look like to their own programs: paint, styles, viewports, and names.

use super::super::{Inside, Scene};
use super::namespaces::{INKSCAPE, SVG};
use super::parse;
use super::tests::{scene, walls};

/// What is said of `inside`, without what is said of every drawing.
fn notes(inside: &str) -> Vec<String> {
    scene(inside).unwrap_or_else(|what| panic!("{inside}: {what}")).notes()[1..].to_vec()
}

#[test]
fn what_is_not_painted_is_no_wall() {
    let walls_of = |style: &str| walls(&format!("<rect width='4' height='3' {style}/>")).len();
    let shown = [
        "",
        "fill='none' stroke='#000'",
        "fill='none' style='stroke:black;stroke-width:0.01px'",
        "stroke='none'",
        "fill='white'",
        "fill='url(#r)' id='r'",
        "fill='url(#no) red'",
        "style='fill:var(--x)'",
        "opacity='0.01'",
        "fill-opacity='0' stroke='red'",
        "fill='currentColor'",
    ];
    for style in shown {
        assert_eq!(walls_of(style), 4, "{style}");
    }
    let unseen = [
        "fill='none'",
        "style='fill:none;stroke:none'",
        "opacity='0'",
        "style='opacity:0%'",
        "fill-opacity='0'",
        "fill='none' stroke='red' stroke-width='0'",
        "fill='none' stroke='red' style='stroke-width:0px'",
        "fill='none' stroke='red' stroke-opacity='0.0'",
        "fill='transparent'",
        "fill='#12345600'",
        "fill='rgba(1,2,3,0)' stroke='none'",
        "fill='url(#no)'",
        "fill='url(#no) none'",
    ];
    for style in unseen {
        let found = scene(&format!("<rect width='4' height='3' {style}/>")).unwrap();
        assert_eq!(found.walls().len(), 0, "{style}");
        let note = "shapes neither filled nor stroked, or of opacity 0, which are no walls: 1";
        assert_eq!(found.notes()[1..], [note], "{style}");
    }
    // Paint is inherited, opacity holds for all that is inside, and a used element is painted where it is used.
    assert_eq!(walls("<g fill='none'><path d='M0,0h1'/><path fill='inherit' d='M0,0h1'/></g>").len(), 0);
    assert_eq!(walls("<g fill='none'><path d='M0,0h1'/><path fill='red' d='M0,0h2'/></g>"), [[0., 0., 2., 0.]]);
    assert_eq!(walls("<g opacity='0'><path d='M0,0h1' opacity='1' stroke='red'/></g>").len(), 0);
    let used = "<defs><path id='p' d='M0,0h1'/></defs><use href='#p' fill='none'/><use href='#p'/>";
    assert_eq!(walls(used).len(), 1);
    // A line has no area to fill; if it is said to have no stroke there is nothing.
    assert_eq!(walls("<line x2='3' stroke='none'/><line x2='4'/>"), [[0., 0., 4., 0.]]);
    // A mark that is not painted marks all the same.
    assert!(scene("<circle id='anchor' cx='3' cy='4' r='1' fill='none'/>").unwrap().anchor().is_some());
    assert!(scene("<rect id='anchor' width='4' height='2' opacity='0'/>").unwrap().anchor().is_some());
}

#[test]
fn comments_of_styles_are_spaces() {
    for style in [
        "style='display:none/*x*/'",
        "style='display:/**/none'",
        "style='display/*y*/:none'",
        "style='/**/display:none/**/!/**/important'",
        "display='none/*x*/'",
        "class='a'",
        "class='b'",
    ] {
        let sheet = "<style>.a{display:/**/none/*x*/} .b/* { */{ /* } */ display/*y*/:none }</style>";
        assert_eq!(walls(&format!("{sheet}<path d='M0,0h1' {style}/>")).len(), 0, "{style}");
    }
    let moved = "<path d='M0,0h1' style='transform:/**/translate(/**/5px)/**/'/>";
    assert_eq!(walls(moved), [[5., 0., 6., 0.]]);
    for (kind, shown) in [("text/less", 1), ("text/css", 0), ("Text/CSS", 0), ("", 0)] {
        let drawn = format!("<style type='{kind}'>path{{display:none}}</style><path d='M0,0h1'/>");
        assert_eq!(walls(&drawn).len(), shown, "{kind}");
        let told = notes(&drawn).iter().any(|note| note.contains("passed over: 1 (type=\"text/less\")"));
        assert_eq!(told, shown == 1, "{kind}");
    }
}

#[test]
fn what_is_initial_is_not_inherited() {
    for (round, own, shown) in [
        ("fill='none'", "fill='initial'", 1),
        ("fill='none'", "fill='unset'", 0),
        ("fill='none'", "fill='inherit'", 0),
        ("fill='none'", "style='fill:INITIAL'", 1),
        ("fill='none' stroke='red'", "stroke='initial'", 0),
        ("fill-opacity='0'", "fill-opacity='initial'", 1),
        ("fill='none' stroke='red' stroke-width='0'", "stroke-width='initial'", 1),
        ("visibility='hidden'", "visibility='initial'", 1),
        ("visibility='hidden'", "style='visibility:initial'", 1),
        ("visibility='hidden'", "visibility='unset'", 0),
        ("visibility='hidden'", "style='visibility:inherit'", 0),
        ("opacity='0'", "opacity='initial'", 0),
        ("display='none'", "display='initial'", 0),
    ] {
        let drawn = format!("<g {round}><path d='M0,0h1' {own}/></g>");
        assert_eq!(walls(&drawn).len(), shown, "{round} {own}");
    }
}

#[test]
fn filled_outlines_are_solid() {
    let inside = |element: &str| {
        let scene = scene(element).unwrap();
        let objects = scene.objects().iter().map(|object| object.inside);
        objects.skip(1).collect::<Vec<_>>()
    };
    let square = "M0,0 h4 v4 h-4";
    for (style, expected) in [
        ("", Inside::NonZero),
        ("fill-rule='evenodd'", Inside::EvenOdd),
        ("style='fill:#ccc;fill-rule:evenodd'", Inside::EvenOdd),
        ("fill='none' stroke='red'", Inside::Free),
        ("fill='#fff' stroke='red'", Inside::Free),
        ("fill-opacity='0' stroke='red'", Inside::Free),
    ] {
        assert_eq!(inside(&format!("<path d='{square}z' {style}/>")), [expected], "{style}");
        assert_eq!(inside(&format!("<path d='{square}z m1,1 h1 v1 z' {style}/>")), [expected], "{style}");
        // What the fill alone closes has a gap in its outline.
        assert_eq!(inside(&format!("<path d='{square}' {style}/>")), [Inside::Free]);
        assert_eq!(inside(&format!("<path d='{square}z M9,9 h4' {style}/>")), [Inside::Free]);
        assert_eq!(inside(&format!("<polygon points='0,0 4,0 4,4' {style}/>")), [expected]);
        assert_eq!(inside(&format!("<polyline points='0,0 4,0 4,4' {style}/>")), [Inside::Free]);
        assert_eq!(inside(&format!("<polyline points='0,0 4,0 4,4 0,0' {style}/>")), [expected]);
        assert_eq!(inside(&format!("<circle r='4' {style}/><rect width='1' height='1' {style}/>")), [expected; 2]);
    }
    // A filled room in which the rope is tied is no solid, but a pillar in it is one; so is what the anchor touches.
    let anchor = |x: f64, y: f64| format!("<circle id='anchor' cx='{x}' cy='{y}' r='.1'/>");
    let room = "<rect width='9' height='9' fill='grey'/><rect x='2' y='2' width='3' height='3'/>";
    let both = [Inside::NonZero, Inside::NonZero];
    assert_eq!(inside(&format!("{room}{}", anchor(1.0, 1.0))), [Inside::Free, Inside::NonZero]);
    assert_eq!(inside(&format!("{room}{}", anchor(2.0, 3.0))), [Inside::Free, Inside::NonZero]);
    assert_eq!(inside(&format!("{room}{}", anchor(3.0, 3.0))), [Inside::Free, Inside::Free]);
    assert_eq!(inside(&format!("{room}{}", anchor(9.0, 3.0))), both);
    assert_eq!(inside(&format!("{room}{}", anchor(0.0, 0.0))), both);
    assert_eq!(inside(&format!("{room}{}", anchor(10.0, 9.0))), both);
    let ring = "<path fill-rule='evenodd' d='M0,0h9v9h-9z M1,1h7v7h-7z'/>";
    assert_eq!(inside(&format!("{ring}{}", anchor(5.0, 5.0))), [Inside::EvenOdd]);
    assert_eq!(inside(&format!("{ring}{}", anchor(0.5, 5.0))), [Inside::Free]);
}

#[test]
fn objects_keep_their_names_and_layers() {
    let of = |inside: &str| {
        let scene = scene(inside).unwrap();
        let object = &scene.objects()[scene.object_of(0)];
        (object.label.clone().unwrap_or_default(), object.layers.clone())
    };
    let path = "<path id='path7' d='M0,0h1'/>";
    assert_eq!(of(path), (String::new(), vec![]));
    let layer = |label: &str, inside: &str| {
        format!("<g id='layer1' inkscape:groupmode='layer' inkscape:label='{label}'>{inside}</g>")
    };
    let named = "<path id='x' inkscape:label='the door' d='M0,0h1'/>";
    let nested = layer("Walls", &format!("<g id='g4'><g id='north'>{named}</g></g>"));
    assert_eq!(of(&nested), ("the door".into(), vec!["Walls".into(), "north".into()]));
    assert_eq!(of(&(layer("empty", "") + path)), (String::new(), vec![]));
    let defs = format!("<defs><g id='chair'>{named}</g><circle id='pillar' r='1'/></defs>");
    assert_eq!(of(&format!("{defs}<use id='use1' href='#pillar'/>")), ("pillar".into(), vec![]));
    assert_eq!(of(&format!("{defs}<use id='second' href='#pillar'/>")), ("second".into(), vec![]));
    assert_eq!(of(&format!("{defs}<use id='third' href='#chair'/>")).1, ["third", "chair"]);
    let symbol = format!("<symbol id='s'>{path}</symbol><g id='hall'><use id='table' href='#s'/></g>");
    assert_eq!(of(&symbol), (String::new(), vec!["hall".into(), "table".into()]));
}

#[test]
fn style_sheets_place_and_size() {
    let line = "<path d='M0,0 H50'/>";
    assert_eq!(walls(&format!("<g style='rotate:90deg'>{line}</g>")), [[0., 0., 0., 50.]]);
    assert_eq!(walls(&format!("<g style='translate:10px 20px'>{line}</g>")), [[10., 20., 60., 20.]]);
    let all = "translate:10px 20px;rotate:90deg;scale:2;transform:translate(1px, 2px)";
    assert_eq!(walls(&format!("<g style='{all}'>{line}</g>")), [[6., 22., 6., 122.]]);
    // A style's transform stands for the attribute's, and its absence for none.
    let moved = "transform='translate(7)'";
    assert_eq!(walls(&format!("<g {moved} style='transform:scale(2)'>{line}</g>")), [[0., 0., 100., 0.]]);
    assert_eq!(walls(&format!("<g {moved} style='transform:none'>{line}</g>")), [[0., 0., 50., 0.]]);
    assert_eq!(
        walls(&format!("<g transform='rotate(90)' transform-origin='10 0'>{line}</g>")),
        [[10., -10., 10., 40.]]
    );
    let middle = "transform:rotate(180deg);transform-origin:center";
    assert_eq!(walls(&format!("<g style='{middle}'>{line}</g>")), [[100., 50., 50., 50.]]);
    let sheet = "<style>rect{width:3px;height:25%;X:1px} #s{height:7px}</style>";
    let walls = walls(&format!("{sheet}<rect/><svg id='s' style='y:2px'><line x2='100%' y2='100%'/></svg>"));
    assert_eq!(walls[0], [1., 0., 4., 0.]);
    assert_eq!(walls[2], [4., 12.5, 1., 12.5]);
    assert_eq!(walls[4], [0., 2., 100., 9.]);
    for (inside, expected) in [
        ("<g style='transform:rotate(9)'/>", "line 2: <g>: transform is \"rotate(9)\" in a style, which is not"),
        ("<g style='offset-path:path(\"M0,0h9\")'/>", "line 2: <g>: moved by the style offset-path"),
        ("<g style='transform:scale(2);transform-box:fill-box;transform-origin:0 0'/>", "\"0 0\" of the fill-box"),
        ("<rect style='width:2em'/>", "line 2: <rect>: width is \"2em\", which depends on a font"),
        ("<rect style='width:inherit'/>", "line 2: <rect>: width is \"inherit\"; it must be a length"),
        ("<use href='#a' id='a' style='x:var(--x)'/>", "x is \"var(--x)\"; it must be a length"),
    ] {
        let what = scene(inside).unwrap_err();
        assert!(what.contains(expected), "{inside}: {what}");
    }
}

#[test]
fn what_is_not_understood_of_styles_is_counted() {
    let sheet = "<style>path:not(.a){display:none} @media print{path{display:none}} p{color:red}</style>";
    let path = "<path d='M0,0h1' style='stroke:var(--s)' stroke-width='a'/>";
    let note = "styles that are not understood and passed over: 4 (@media, path:not(.a), stroke: var(--s))";
    assert_eq!(notes(&format!("{sheet}{path}")), [note]);
    let text = format!("<?xml-stylesheet href='a.css'?><svg xmlns='{SVG}'><path d='M0,0h1'/></svg>");
    let note = "styles that are not understood and passed over: 1 (xml-stylesheet)";
    assert_eq!(parse(&text, None).unwrap().notes()[1..], [note]);
}

#[test]
fn nested_drawings_that_reach_beyond_their_edges_are_told_of() {
    let note = |count: usize| {
        format!(
            "nested drawings and symbols are not cut at their edges; elements that reach beyond, taken whole: {count}"
        )
    };
    let svg = |style: &str, inside: &str| format!("<svg x='10' y='10' width='20' height='20' {style}>{inside}</svg>");
    let long = "<path d='M-5,10 H60'/>";
    assert_eq!(notes(&svg("", &format!("{long}<path d='M1,1 H20'/>"))), [note(1)]);
    assert_eq!(notes(&svg("", "<path d='M0,0 h20 v20 h-20z'/>")), [""; 0]);
    assert_eq!(notes(&svg("style='overflow:visible'", long)), [""; 0]);
    assert_eq!(notes(&svg("viewBox='0 0 100 100'", long)), [note(1)]);
    assert_eq!(notes(&svg("viewBox='-10 0 100 100'", long)), [""; 0]);
    assert_eq!(notes(&svg("transform='rotate(30)'", "<path d='M0,0 h20 v20 h-20z'/>")), [""; 0]);
    // Control points beyond the edge are no part of the curve.
    let curve = notes(&svg("", "<path d='M0,0 Q10,40 20,0'/>"));
    assert_eq!(curve.len(), 1, "{curve:?}");
    let symbol = format!("<symbol id='s' viewBox='0 0 10 10'>{long}</symbol>");
    assert_eq!(notes(&format!("{symbol}<use href='#s' width='5'/><use href='#s'/>")), [note(2)]);
    let nothing = scene(&svg("style='width:0px'", long)).unwrap();
    assert!(nothing.walls().is_empty() && nothing.notes()[1].starts_with("hidden elements"));
}

#[test]
fn a_unit_is_what_both_sides_say() {
    let unit = |attributes: &str| {
        let scene = parse(&format!("<svg xmlns='{SVG}' {attributes}><path d='M1,2h3'/></svg>"), None);
        scene.map(|scene| scene.notes()[0].replace("; y points down, as in the file", "")).map_err(|fault| fault.what)
    };
    let ok = |what: &str| Ok::<String, String>(what.into());
    let half = "a unit is 0.5 mm (the drawing is 25 mm high, its viewBox 50)";
    assert_eq!(unit("width='100mm' height='25mm' viewBox='0 0 100 50'"), ok(half));
    assert_eq!(unit("height='25mm' viewBox='0 0 100 50'"), ok(half));
    let filled = "a unit is 1 mm (the drawing is 100 mm wide, its viewBox 100)";
    let sides = "width='100mm' height='25mm' viewBox='0 0 100 50'";
    assert_eq!(unit(&format!("{sides} preserveAspectRatio='xMidYMid slice'")), ok(filled));
    assert_eq!(unit("style='width:100mm;height:5cm' viewBox='0 0 100 50'"), ok(filled));
    assert_eq!(unit("width='100mm' height='100%' viewBox='0 0 100 50'"), ok(filled));
    let same = "width='100mm' height='50mm' viewBox='0 0 100 50' preserveAspectRatio='none'";
    assert_eq!(unit(same), ok(filled));
    let one = "width='100mm' viewBox='0 0 100 50' preserveAspectRatio='none'";
    assert_eq!(unit(one), ok("units are those of the viewBox"));
    let two = unit("width='100mm' height='100mm' viewBox='0 0 100 50' preserveAspectRatio='none'").unwrap_err();
    assert!(two.starts_with("<svg>: a unit is 1 mm along x, but 2 mm along y; make both sides fit"), "{two}");
}

#[test]
fn markers_and_wide_strokes_are_told_of() {
    let lines =
        "<path d='M0,0 H100 V50' style='marker-end:url(#m)'/><g marker-mid='url(#m)'><rect width='1' height='1'/></g>";
    let note = "markers such as arrow heads are no walls, but the lines that bear them are; lines with markers: 1";
    assert_eq!(notes(lines), [note]);
    let strokes = "<path d='M0,0 H100' stroke='red' stroke-width='3'/><g transform='scale(4)' stroke='red'>\
        <path d='M0,0 H1'/><path stroke-width='.2' d='M0,0 H1'/><path stroke='none' d='M0,0 H1' stroke-width='9'/></g>";
    let note = "walls are the middle of strokes, whose widest is 4 wide; wide strokes: 2";
    assert_eq!(notes(strokes), [note]);
}

#[test]
fn shapes_without_length_are_dropped_and_counted() {
    let dropped = |inside: &str| scene(inside).unwrap().dropped();
    assert_eq!(dropped("<circle/><rect width='3'/><ellipse rx='0' ry='2'/><path d='M1,1'/><polygon/><path/>"), 6);
    assert_eq!(dropped("<line/><path d='M1,1 h0 v1'/><polyline points='1,1'/>"), 3);
    let flat = scene("<g transform='scale(0 1)'><path d='M0,0h1v1'/></g>").unwrap();
    assert_eq!((flat.walls().len(), &flat.notes()[1..]), (0, &["hidden elements, which are no walls: 1".into()][..]));
    assert_eq!(dropped("<circle id='anchor'/><rect width='400' height='200' rx='134'/>"), 0);
}

#[test]
fn what_is_nearly_called_anchor_is_told_of() {
    let note = |inside: &str| notes(inside).into_iter().find(|note| note.contains("anchor"));
    let expected = "<circle> in line 2 is called \"Anchor\" and is taken for what it draws; the id or label that marks \
        the anchor is \"anchor\"";
    assert_eq!(note("<circle id='Anchor' r='1'/>").as_deref(), Some(expected));
    assert_eq!(note("<circle id='c5' inkscape:label='Anchor' r='1'/>").as_deref(), Some(expected));
    for called in ["ANCHOR", "anchor1", "anchors", "Anchor point", " anchor"] {
        assert!(note(&format!("<circle id='{called}' r='1'/>")).is_some(), "{called}");
    }
    assert!(note("<circle r='1'><title>anchor</title></circle>").is_some());
    assert!(note("<circle id='anchorage' r='1'/>").is_none());
    // One that is marked rightly is enough.
    assert!(note("<circle id='Anchor' r='1'/><circle id='anchor' r='1'/>").is_none());
    assert!(note("<defs><circle id='Anchor' r='1'/></defs>").is_none());
}

#[test]
fn drawings_without_a_namespace_have_styles() {
    let text = format!("<svg xmlns:inkscape='{INKSCAPE}'><style>path{{display:none}}</style><path d='M0,0h1'/></svg>");
    let scene: Scene = parse(&text, None).unwrap();
    assert!(scene.walls().is_empty());
}
