//! One rope that follows a hand: each move answered at once with the direction in which the rope pulls.
//!
//!     cargo run --release --example haptic_loop

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;
use tautline::engine::{AdvanceError, LiveRope};
use tautline::example::BuiltIn;
use tautline::scene::Model;

fn main() -> Result<(), Box<dyn Error>> {
    let model = Arc::new(Model::new(BuiltIn::Rooms.scene(1), None)?);
    let mut rope = LiveRope::new(model.clone());

    // A hand that goes on in long curves, and turns where a wall stops it.
    let (mut heading, mut moves, mut refused, mut events) = (0.0f64, 0u32, 0u32, 0);
    let clock = Instant::now();
    while moves < 100_000 {
        heading += 0.05 * (0.013 * f64::from(moves)).sin();
        match rope.advance(rope.free_end() + 0.02 * DVec2::from_angle(heading)) {
            Ok(happened) => (moves, events) = (moves + 1, events + happened.len()),
            Err(AdvanceError::Touches { .. }) => (heading, refused) = (heading + 2.4, refused + 1),
            Err(error) => return Err(error.into()),
        }
    }
    let each = clock.elapsed().as_secs_f64() / f64::from(moves + refused) * 1e6;
    println!("{moves} moves, {refused} stopped by walls, {events} wraps and unwraps; {each:.2} us each");
    let pull = rope.pull().unwrap_or(DVec2::ZERO);
    println!("the rope is {:.3} long and pulls along ({:.3}, {:.3})", rope.length(), pull.x, pull.y);
    Ok(())
}
