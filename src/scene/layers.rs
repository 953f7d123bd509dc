//! Which layers of a scene are taken.

use std::collections::BTreeSet;

use super::{Object, Scene, SceneOptions};
use crate::read_error::{Fault, Place};

/// How many layers an error names.
const NAMED: usize = 50;

/// The properties of GeoJSON features by which walls are chosen: those of the names `KEY=VALUE`.
pub(super) fn keys(options: &SceneOptions) -> BTreeSet<&str> {
    let names = options.layers.iter().chain(&options.without_layers);
    names.filter_map(|name| Some(name.split_once('=')?.0)).collect()
}

/// The scene with the walls of those layers only that are asked for. An object lies in all layers that it names; it is
/// left out if it lies in any that is left out.
pub(super) fn choose(scene: Scene, options: &SceneOptions) -> Result<Scene, Fault> {
    let SceneOptions { layers: only, without_layers: without, .. } = options;
    if only.is_empty() && without.is_empty() {
        return Ok(scene);
    }
    let there = scene.layers();
    if let Some(name) = only.iter().chain(without).find(|name| !there.contains_key(name.as_str())) {
        let names: Vec<&str> = there.keys().copied().collect();
        return Err(Fault::new(Place::default(), missing(name, &names)));
    }
    let lies_in = |object: &Object, names: &[String]| object.layers.iter().any(|layer| names.contains(layer));
    let is_kept = |object: &Object| (only.is_empty() || lies_in(object, only)) && !lies_in(object, without);
    let mut chosen = scene.of_objects(is_kept);
    let listed = |which: &str, names: &[String]| match names {
        [] => String::new(),
        names => format!(", {which} {}", names.join(", ")),
    };
    let (kept, all) = (chosen.walls.len(), scene.walls.len());
    let which = [listed("of the layers", only), listed("without", without)].concat();
    chosen.note(format!("{kept} of {all} walls are taken{which}"));
    Ok(chosen)
}

/// What is said of a layer that is not there.
fn missing(name: &str, there: &[&str]) -> String {
    if there.is_empty() {
        return format!("no layer {name:?}: nothing in this file lies in a layer");
    }
    let distance = |other: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &other.to_lowercase());
    let nearest = there.iter().map(|other| (distance(other), other)).min();
    let nearest = nearest.filter(|(distance, other)| *distance <= 1 + other.chars().count() / 3);
    let nearest = nearest.map_or(String::new(), |(_, other)| format!("; did you mean {other:?}?"));
    let names: Vec<String> = there.iter().take(NAMED).map(|name| format!("{name:?}")).collect();
    let more = there.len().checked_sub(NAMED).filter(|&more| more > 0);
    let more = more.map_or(String::new(), |more| format!(" and {more} more"));
    format!(
        "no layer {name:?}{nearest}{} the layers are {}{more}",
        if nearest.is_empty() { ";" } else { "" },
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::{Inside, Wall};
    use super::*;

    /// Walls in the layers `a`, `a` and `b`, `b`, and none.
    fn scene() -> Scene {
        let object = |layers: &[&str]| Object {
            layers: layers.iter().map(|&l| l.to_owned()).collect(),
            inside: Inside::EvenOdd,
            label: Some(layers.concat()),
        };
        let objects = vec![object(&["a"]), object(&["a", "b", "a"]), object(&["b"]), object(&[])];
        let wall = |i: u32| Wall {
            ends: [[f64::from(i), 0.0].into(), [f64::from(i), 1.0].into()],
            object: i % 4,
            reversed: i == 2,
        };
        Scene::of(objects, (0..5).map(wall)).unwrap().with_anchor([9.0, 9.0].into()).with_y_down()
    }

    fn options(layers: &[&str], without: &[&str]) -> SceneOptions {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        SceneOptions { layers: owned(layers), without_layers: owned(without), ..Default::default() }
    }

    #[test]
    fn walls_of_the_layers_asked_for_are_taken() {
        for (only, without, expected) in [
            (&["a"][..], &[][..], &[0.0, 1.0, 4.0][..]),
            (&["a", "b"], &[], &[0.0, 1.0, 2.0, 4.0]),
            (&[], &["a"], &[2.0, 3.0]),
            (&["a"], &["b"], &[0.0, 4.0]),
            (&["b"], &["a", "b"], &[]),
        ] {
            let chosen = choose(scene(), &options(only, without)).unwrap();
            let found: Vec<f64> = (0..chosen.walls().len()).map(|wall| chosen.ends(wall)[0].x).collect();
            assert_eq!(found, expected, "{only:?} {without:?}");
            assert_eq!((chosen.anchor(), chosen.y_down()), (Some([9.0, 9.0].into()), true));
            for wall in 0..chosen.walls().len() {
                let [x, turned] = [chosen.ends(wall)[0].x, chosen.outline(wall)[0].y];
                assert_eq!(turned, if x == 2.0 { 1.0 } else { 0.0 });
                assert_eq!(chosen.objects()[chosen.object_of(wall)], scene().objects()[x as usize % 4]);
            }
        }
        assert_eq!(
            choose(scene(), &options(&["a"], &["b"])).unwrap().notes(),
            ["2 of 5 walls are taken, of the layers a, without b"]
        );
        assert_eq!(choose(scene(), &options(&[], &[])).unwrap().notes(), [""; 0]);
        assert_eq!(scene().layers().into_iter().collect::<Vec<_>>(), [("a", 3), ("b", 2)]);
    }

    #[test]
    fn a_layer_that_is_not_there_is_an_error_that_lists_the_layers() {
        let fault = |scene, options| choose(scene, &options).unwrap_err().what;
        assert_eq!(fault(scene(), options(&[], &["A"])), r#"no layer "A"; did you mean "a"? the layers are "a", "b""#);
        assert_eq!(fault(scene(), options(&["walls"], &[])), r#"no layer "walls"; the layers are "a", "b""#);
        let none = Scene::new([[[0.0, 0.0].into(), [1.0, 0.0].into()]]).unwrap();
        assert_eq!(fault(none, options(&["x"], &[])), r#"no layer "x": nothing in this file lies in a layer"#);
        let many: Vec<String> = (0..60).map(|i| format!("layer {i:02}")).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(missing("xyz", &many).ends_with("\"layer 49\" and 10 more"));
    }

    #[test]
    fn a_vertex_has_the_label_of_the_first_wall_that_names_it() {
        let object = |label: Option<&str>| Object { label: label.map(str::to_owned), ..Object::default() };
        let ends = [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]].map(|x: [f64; 2]| x.map(|x| [x, 0.0].into()));
        let walls =
            |order: [u32; 3]| ends.into_iter().zip(order).map(|(ends, object)| Wall { ends, object, reversed: false });
        let of = |order| {
            Scene::of(vec![object(Some("pillar 3")), object(None), object(Some("door"))], walls(order)).unwrap()
        };
        assert_eq!(of([0, 1, 2]).labels(), [Some("pillar 3"), Some("pillar 3"), None, Some("door")]);
        assert_eq!(of([1, 1, 0]).labels(), [None, None, None, Some("pillar 3")]);
        assert!(of([1, 1, 1]).labels().is_empty());
    }
}
