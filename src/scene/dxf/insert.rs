//! Parts of a drawing that are inserted by their names.

use std::rc::Rc;

use glam::{DAffine2, DVec2};

use super::super::curves::direction;
use super::super::{excerpt, nearly_anchor};
use super::block::Block;
use super::entity::{Entities, Entity};
use super::shapes::{point, upside};
use super::{Context, MIRRORED, Reader};
use crate::read_error::Fault;

/// How deep blocks may lie in each other.
const DEPTH_MAX: usize = 64;

/// Bits of a block's flags: it stands for a drawing in another file.
const EXTERNAL: i64 = 4;
const OVERLAY: i64 = 8;

impl<'a> Reader<'a> {
    pub(super) fn block(&mut self, head: &Entity<'a>, entities: &mut Entities<'a>) -> Result<(), Fault> {
        let base = DVec2::new(head.or(10, 0.0)?, head.or(20, 0.0)?);
        let external = head.flags(70)? & (EXTERNAL | OVERLAY) != 0;
        let file = head.text(1).filter(|file| !file.is_empty()).or(head.text(2));
        let mut block = Block { base, entities: Vec::new(), file: file.filter(|_| external) };
        while let Some(entity) = entities.next()? {
            match entity.kind {
                "ENDBLK" => break,
                "ENDSEC" | "BLOCK" => return Err(head.fault("has no ENDBLK")),
                _ => block.entities.push(entity),
            }
        }
        self.blocks.insert(head.text(2).unwrap_or_default().to_uppercase(), Rc::new(block));
        Ok(())
    }

    /// Draws a block once, or in columns and rows.
    pub(super) fn insert(&mut self, insert: &Entity<'a>, context: &Context<'_>) -> Result<(), Fault> {
        let name = insert.text(2).unwrap_or_default();
        let Some(block) = self.blocks.get(&name.to_uppercase()).cloned() else {
            return Err(insert.fault(format_args!("the drawing has no block {name:?}")));
        };
        if context.depth >= DEPTH_MAX {
            return Err(insert.fault(format_args!("blocks lie in each other more than {DEPTH_MAX} deep")));
        }
        if nearly_anchor(name) && self.nearly.is_none() {
            self.nearly = Some(format!("INSERT in line {} is of the block {:?}", insert.line, excerpt(name)));
        }
        if let (Some(file), true) = (block.file, block.entities.is_empty()) {
            *self.elsewhere.entry(excerpt(file)).or_default() += 1;
            return Ok(());
        }
        self.clips.inserted(insert);
        let way = direction(insert.or(50, 0.0)?);
        let turn = DAffine2::from_cols(way, way.perp(), DVec2::ZERO);
        let scale = DVec2::new(insert.or(41, 1.0)?, insert.or(42, 1.0)?);
        if scale.x == 0.0 || scale.y == 0.0 {
            self.dropped += 1;
            return Ok(());
        }
        let spacing = DVec2::new(insert.or(44, 0.0)?, insert.or(45, 0.0)?);
        let mut outer = context.transform;
        if upside(insert)? < 0.0 {
            outer *= MIRRORED;
        }
        outer *= DAffine2::from_translation(point(insert, 10)?) * turn;
        // Names that begin with a star are made up.
        let label = Some(name).filter(|name| !name.starts_with('*') && !name.is_empty());
        for row in 0..insert.flags(71)?.max(1) {
            for column in 0..insert.flags(70)?.max(1) {
                self.count(insert)?;
                let by = spacing * DVec2::new(column as f64, row as f64);
                let place = DAffine2::from_translation(by) * DAffine2::from_scale(scale);
                let transform = outer * place * DAffine2::from_translation(-block.base);
                let inner = Context { transform, depth: context.depth + 1, label: label.or(context.label), ..*context };
                block.entities.iter().try_for_each(|entity| self.entity(entity, &inner))?;
            }
        }
        Ok(())
    }
}
