//! Steps as text. Numbers are the shortest decimals that read back to the same f64.

use std::io::{self, Write};

use super::labels::field;
use super::text::number;
use crate::rope::StepColumns;
use crate::scene::Centre;

const HEADER: [&str; 2] = ["trace,step,x,y", ",length,contacts,turns,pull_x,pull_y"];

/// What the column of windings about a centre is called.
pub(super) fn winding(centre: &Centre) -> String {
    format!("winding_{}", centre.name)
}

/// The first line of CSV, with where the anchor is if it moves.
pub(super) fn header(centres: &[Centre], both_move: bool) -> String {
    let mut line = HEADER.join(if both_move { ",bx,by" } else { "" }).into_bytes();
    for centre in centres {
        line.push(b',');
        field(&mut line, &winding(centre)).expect("memory takes all");
    }
    String::from_utf8(line).expect("it is text")
}

pub(super) fn csv(out: &mut Vec<u8>, columns: &StepColumns, row: usize) -> io::Result<()> {
    let c = columns;
    write!(out, "{},{}", c.trace[row], c.step[row])?;
    let anchor = [&c.bx, &c.by].into_iter().filter_map(|b| b.get(row).copied());
    for x in [c.x[row], c.y[row]].into_iter().chain(anchor).chain([c.length[row]]) {
        out.push(b',');
        number(out, x)?;
    }
    write!(out, ",{},{}", c.contacts[row], c.turns[row])?;
    for pull in [c.pull_x[row], c.pull_y[row]] {
        out.push(b',');
        if c.pulls[row] {
            number(out, pull)?;
        }
    }
    c.windings.iter().try_for_each(|windings| write!(out, ",{}", windings[row]))?;
    out.push(b'\n');
    Ok(())
}

/// An object; the fields' order is the columns'.
pub(super) fn json(out: &mut Vec<u8>, columns: &StepColumns, row: usize, centres: &[Centre]) -> io::Result<()> {
    let c = columns;
    write!(out, "{{\"trace\":{},\"step\":{}", c.trace[row], c.step[row])?;
    let anchor = [("bx", &c.bx), ("by", &c.by)].into_iter().filter_map(|(name, b)| Some((name, *b.get(row)?)));
    for (name, x) in [("x", c.x[row]), ("y", c.y[row])].into_iter().chain(anchor).chain([("length", c.length[row])]) {
        write!(out, ",\"{name}\":")?;
        number(out, x)?;
    }
    write!(out, ",\"contacts\":{},\"turns\":{}", c.contacts[row], c.turns[row])?;
    for (name, pull) in [("pull_x", c.pull_x[row]), ("pull_y", c.pull_y[row])] {
        write!(out, ",\"{name}\":")?;
        match c.pulls[row] {
            true => number(out, pull)?,
            false => out.extend_from_slice(b"null"),
        }
    }
    for (centre, windings) in centres.iter().zip(&c.windings) {
        out.push(b',');
        serde_json::to_writer(&mut *out, &winding(centre))?;
        write!(out, ":{}", windings[row])?;
    }
    out.extend_from_slice(b"}\n");
    Ok(())
}
