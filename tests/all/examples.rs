//! The programs in `examples/` run and say what they are for.

use std::process::Command;

fn said(example: &str) -> String {
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--release", "--quiet", "--example", example]).current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{example}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn examples_say_what_they_are_for() {
    let quarters = said("in_memory");
    assert_eq!(quarters.lines().count(), 9);
    assert!(
        quarters.contains("8 quarters") && quarters.contains("(-1, -1) (1, -1) (1, 1) (-1, 1) (-1, -1)"),
        "{quarters}"
    );
    let live = said("haptic_loop");
    assert!(live.starts_with("100000 moves") && live.contains("pulls along"), "{live}");
    let steps = said("rope_at_every_step");
    assert_eq!(steps.lines().count(), 62);
    assert!(steps.lines().any(|line| line.contains("[") && !line.contains("[]")), "{steps}");
    let study = said("tether_study");
    assert!(study.starts_with("the mean of the greatest length: ") && study.contains("% of the walks"), "{study}");
}
