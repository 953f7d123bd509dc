//! Steps as text. Numbers are the shortest decimals that read back to the same f64.

use std::io::{self, Write};

use super::Extras;
use super::labels::field;
use super::text::number;
use crate::rope::{StepColumns, StrainColumns};
use crate::scene::Centre;

const HEADER: [&str; 2] = ["trace,step,x,y", ",length,contacts,turns,pull_x,pull_y"];

/// What the columns are called that friction brings, and what they hold.
pub(super) const STRAIN: [&str; 5] = ["anchor_pull_x", "anchor_pull_y", "turned", "tension", "work"];

/// The columns that friction brings.
pub(super) fn strain(columns: StrainColumns) -> [Vec<f64>; STRAIN.len()] {
    let StrainColumns { anchor_pull_x, anchor_pull_y, turned, tension, work } = columns;
    [anchor_pull_x, anchor_pull_y, turned, tension, work]
}

/// The numbers of a row that friction brings, none where there is none: a pull only where the rope has one.
fn strained(c: &StepColumns, row: usize) -> impl Iterator<Item = (&'static str, Option<f64>)> {
    let StrainColumns { anchor_pull_x, anchor_pull_y, turned, tension, work } = &c.strain;
    let pulls = [anchor_pull_x, anchor_pull_y].map(|pull| pull.get(row).map(|&x| c.pulls[row].then_some(x)));
    let others = [turned, tension, work].map(|column| column.get(row).map(|&x| Some(x)));
    let all = pulls.into_iter().chain(others).flatten();
    STRAIN.into_iter().zip(all)
}

/// What the column of windings about a centre is called.
pub(super) fn winding(centre: &Centre) -> String {
    format!("winding_{}", centre.name)
}

/// The first line of CSV, with where the anchor is if it moves.
pub(super) fn header(extras: &Extras, both_move: bool) -> String {
    let mut line = HEADER.join(if both_move { ",bx,by" } else { "" }).into_bytes();
    for name in STRAIN.iter().filter(|_| extras.friction.is_some()) {
        line.push(b',');
        line.extend_from_slice(name.as_bytes());
    }
    for centre in &extras.centres {
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
    for (_, x) in strained(c, row) {
        out.push(b',');
        match x {
            Some(x) if x.is_finite() => number(out, x)?,
            // What CSV has no digits for: readers know it by this name.
            Some(_) => out.extend_from_slice(b"inf"),
            None => {}
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
    for (name, x) in strained(c, row) {
        write!(out, ",\"{name}\":")?;
        match x.filter(|x| x.is_finite()) {
            Some(x) => number(out, x)?,
            // JSON has no infinity either.
            None => out.extend_from_slice(b"null"),
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
