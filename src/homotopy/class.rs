//! A class as a word.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rope's homotopy class: a reduced word in the obstacles, and where it starts if the anchor stands on a wall.
///
/// A letter says that the rope passes over an obstacle's cut: `o12` counter-clockwise about obstacle 12, `o12^-1`
/// clockwise, `o12^3` three times. Letters follow each other from the anchor on; `e` is the word without letters. If
/// ropes can leave the anchor on several sides of the walls on which it stands, `@1` in front of the word says on
/// which.
///
/// As text it is read back by [`str::parse`]. Counter-clockwise is meant as if y pointed up; [`shown`](Self::shown)
/// gives what a picture shows.
///
/// ```
/// use tautline::homotopy::Class;
/// let class: Class = "o12 o7^-2 o7 o3".parse()?;
/// assert_eq!(class.to_string(), "o12 o7^-1 o3");
/// assert_eq!(class.windings().collect::<Vec<_>>(), [(3, 1), (7, -1), (12, 1)]);
/// assert_eq!("o5 o5^-1".parse::<Class>()?, Class::default());
/// # Ok::<(), tautline::homotopy::NoClass>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
pub struct Class {
    /// On which side of the walls at the anchor it starts, where there are several.
    start: Option<u32>,
    /// Obstacles with how often; no two neighbours are the same obstacle, none is 0.
    word: Vec<(u32, i64)>,
}

impl Class {
    /// The empty word of a rope that starts on that side of the anchor's walls.
    pub(super) fn starting(start: Option<u32>) -> Self {
        Class { start, word: Vec::new() }
    }

    /// Adds letters at the end, and cancels what they cancel. O(1).
    pub(super) fn push(&mut self, obstacle: u32, times: i64) {
        if let Some((last, power)) = self.word.last_mut()
            && *last == obstacle
        {
            *power += times;
            if *power == 0 {
                self.word.pop();
            }
        } else if times != 0 {
            self.word.push((obstacle, times));
        }
    }

    /// The word from the anchor on: obstacles, each with how often the rope passes over its cut counter-clockwise in a
    /// row, negative where it is clockwise. No two neighbours are the same obstacle.
    pub fn word(&self) -> &[(u32, i64)] {
        &self.word
    }

    /// On which side of the walls on which the anchor stands the rope starts, where there are several.
    pub fn start(&self) -> Option<u32> {
        self.start
    }

    /// How often the rope winds about each obstacle: cuts passed counter-clockwise less those passed clockwise. Those
    /// for which that is not 0, ascending. O(letters log letters).
    ///
    /// Ropes of one class have the same numbers. Ropes with the same numbers need not be of one class: the order of the
    /// letters matters too.
    pub fn windings(&self) -> impl Iterator<Item = (u32, i64)> + use<> {
        let mut sums = std::collections::BTreeMap::<u32, i64>::new();
        self.word.iter().for_each(|&(obstacle, power)| *sums.entry(obstacle).or_default() += power);
        sums.into_iter().filter(|&(_, sum)| sum != 0)
    }

    /// The class as a picture shows it: with all powers the other way where y points down
    /// ([`Scene::y_down`](crate::scene::Scene::y_down)). Twice, it is the class itself.
    #[must_use]
    pub fn shown(mut self, y_down: bool) -> Self {
        if y_down {
            self.word.iter_mut().for_each(|(_, power)| *power = -*power);
        }
        self
    }
}

impl Display for Class {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut space = "";
        if let Some(start) = self.start {
            write!(f, "@{start}")?;
            space = " ";
        } else if self.word.is_empty() {
            return f.write_str("e");
        }
        for &(obstacle, power) in &self.word {
            write!(f, "{space}o{obstacle}")?;
            if power != 1 {
                write!(f, "^{power}")?;
            }
            space = " ";
        }
        Ok(())
    }
}

/// A text that is no class.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{part:?} is no letter of a class; give letters such as o12, o12^-1 and o12^3 with spaces between them, or e")]
pub struct NoClass {
    part: String,
}

impl FromStr for Class {
    type Err = NoClass;

    fn from_str(text: &str) -> Result<Self, NoClass> {
        let mut class = Class::default();
        let mut parts = text.split_whitespace().peekable();
        if parts.peek().is_none() {
            return Err(NoClass { part: text.to_owned() });
        }
        for (i, part) in parts.enumerate() {
            let letter = || {
                let (obstacle, power) = part.strip_prefix('o')?.split_once('^').unwrap_or((&part[1..], "1"));
                // So few that no sum of them is out of range.
                let power = power.parse::<i32>().ok()?;
                Some((digits(obstacle)?, i64::from(power)))
            };
            match (part, part.strip_prefix('@').and_then(digits), letter()) {
                ("e", _, _) => {}
                (_, Some(start), _) if i == 0 => class.start = Some(start),
                (_, _, Some((obstacle, power))) => class.push(obstacle, power),
                _ => return Err(NoClass { part: part.to_owned() }),
            }
        }
        Ok(class)
    }
}

/// A number without a sign.
fn digits(text: &str) -> Option<u32> {
    text.starts_with(|c: char| c.is_ascii_digit()).then(|| text.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        for text in ["e", "o0", "@0", "@2 o7^-1 o0^12 o7", "o4294967295^-2147483648"] {
            assert_eq!(text.parse::<Class>().unwrap().to_string(), text);
        }
        for text in ["", " ", "o", "7", "o-1", "o7^", "o7^x", "o+7", "@", "o1 @1", "o4294967296", "o1^9999999999"] {
            assert!(text.parse::<Class>().is_err(), "{text}");
        }
    }

    #[test]
    fn letters_cancel_through_and_through() {
        let class: Class = "o1 o2 o3^2 o3^-2 o2^-1 o1^-1 e".parse().unwrap();
        assert_eq!(class, Class::default());
        let class: Class = "o1 o2 o1^-1 o2^-1".parse().unwrap();
        assert_eq!((class.windings().count(), class.word().len()), (0, 4));
        assert_eq!(class.clone().shown(true).to_string(), "o1^-1 o2^-1 o1 o2");
        assert_eq!(class.clone().shown(true).shown(true), class);
    }
}
