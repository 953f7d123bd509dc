//! Which sums and products shaders contain, read off their source: that the probe asks for all of them.
//!
//! A *shape* is how sums and products of f32 hang together, with the same letter for the same number: `(a*b)-(c*d)` is
//! a cross product. Compilers rewrite by shape: one that keeps `(a+b)-a` as it is may take `(a-b)+b` for `a`. So calls
//! are followed, as compilers do that put functions in place, and so is what was kept in a variable and taken out
//! again.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{
    BinaryOperator, Block, Expression, Function, Handle, MathFunction, Module, ScalarKind, Statement, TypeInner,
    UnaryOperator,
};

#[derive(Debug, Clone)]
enum Tree {
    /// Any number that is not itself a sum or product, by what it is.
    Leaf(String),
    Operation(&'static str, Vec<Tree>),
}

/// A function as it is called from one place.
struct Frame<'m> {
    number: usize,
    function: &'m Function,
    info: &'m naga::valid::FunctionInfo,
    caller: Option<(Rc<Frame<'m>>, &'m [Handle<Expression>])>,
}

/// A value that is kept in a variable: where that lies, and the value.
struct Kept<'m> {
    frame: Rc<Frame<'m>>,
    pointer: Handle<Expression>,
    value: Handle<Expression>,
}

/// A part of a value: the member of a struct or the component of a vector.
type Path = Vec<u32>;

/// For some variables, which of the values kept there is taken out again.
type Choice = BTreeMap<String, usize>;

struct Reader<'m> {
    module: &'m Module,
    info: &'m ModuleInfo,
    frames: Vec<Rc<Frame<'m>>>,
    /// What is called from where: the frame and the expression that is the result.
    calls: BTreeMap<(usize, usize), Rc<Frame<'m>>>,
    kept: Vec<Kept<'m>>,
}

/// The shapes of all sums and products of f32 that a shader compares, keeps or gives, as a whole.
pub(super) fn shapes(wgsl: &str) -> BTreeSet<String> {
    let module = naga::front::wgsl::parse_str(wgsl).unwrap_or_else(|e| panic!("{}", e.emit_to_string(wgsl)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
    let mut reader = Reader { module: &module, info: &info, frames: vec![], calls: BTreeMap::new(), kept: vec![] };
    for (i, entry) in module.entry_points.iter().enumerate() {
        reader.enter(&entry.function, info.get_entry_point(i), None);
    }
    let mut found = BTreeSet::new();
    for choice in reader.choices() {
        for (frame, handle) in reader.results() {
            for path in reader.components(frame, handle) {
                let tree = reader.tree(frame, handle, &path, &choice);
                if matches!(tree, Tree::Operation(..)) {
                    found.insert(written(&tree, &mut vec![]));
                }
            }
        }
    }
    found
}

/// The tree as text, its leaves lettered in the order in which they come.
fn written(tree: &Tree, leaves: &mut Vec<String>) -> String {
    match tree {
        Tree::Leaf(name) => {
            let place = leaves.iter().position(|l| l == name).unwrap_or_else(|| {
                leaves.push(name.clone());
                leaves.len() - 1
            });
            char::from(b'a' + u8::try_from(place).unwrap()).to_string()
        }
        Tree::Operation(sign, parts) => {
            let parts: Vec<String> = parts.iter().map(|part| written(part, leaves)).collect();
            match &parts[..] {
                [one] => format!("({sign}{one})"),
                parts => format!("({})", parts.join(sign)),
            }
        }
    }
}

impl<'m> Reader<'m> {
    fn enter(
        &mut self,
        function: &'m Function,
        info: &'m naga::valid::FunctionInfo,
        caller: Option<(Rc<Frame<'m>>, &'m [Handle<Expression>])>,
    ) -> Rc<Frame<'m>> {
        let frame = Rc::new(Frame { number: self.frames.len(), function, info, caller });
        self.frames.push(Rc::clone(&frame));
        self.walk(&frame, &function.body);
        frame
    }

    fn walk(&mut self, frame: &Rc<Frame<'m>>, block: &'m Block) {
        for statement in block.iter() {
            match statement {
                Statement::Block(block) => self.walk(frame, block),
                Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|b| self.walk(frame, b)),
                Statement::Loop { body, continuing, .. } => {
                    [body, continuing].into_iter().for_each(|b| self.walk(frame, b));
                }
                Statement::Switch { cases, .. } => cases.iter().for_each(|case| self.walk(frame, &case.body)),
                &Statement::Store { pointer, value } => {
                    self.kept.push(Kept { frame: Rc::clone(frame), pointer, value });
                }
                Statement::Call { function, arguments, result } => {
                    let caller = Some((Rc::clone(frame), &arguments[..]));
                    let called = self.enter(&self.module.functions[*function], &self.info[*function], caller);
                    if let Some(result) = result {
                        self.calls.insert((frame.number, result.index()), called);
                    }
                }
                Statement::Emit(_) | Statement::Return { .. } | Statement::Break | Statement::Continue => {}
                other => panic!("{other:?}: teach this test what to make of it"),
            }
        }
    }

    /// What is not only an operand of another sum or product: what is compared or chosen from, and what is kept.
    fn results(&self) -> Vec<(&Frame<'m>, Handle<Expression>)> {
        let mut results: Vec<_> = self.kept.iter().map(|kept| (&*kept.frame, kept.value)).collect();
        for frame in &self.frames {
            for (_, expression) in frame.function.expressions.iter() {
                let parts = match *expression {
                    Expression::Binary { op, left, right } if !is_arithmetic(op) => vec![left, right],
                    Expression::Math { arg, arg1, arg2, .. } => [Some(arg), arg1, arg2].into_iter().flatten().collect(),
                    Expression::Select { accept, reject, .. } => vec![accept, reject],
                    Expression::As { expr, .. } => vec![expr],
                    _ => vec![],
                };
                results.extend(parts.into_iter().map(|part| (&**frame, part)));
            }
        }
        results
    }

    /// The paths of the f32 in a value.
    fn components(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> Vec<Path> {
        self.paths(frame.info[handle].ty.inner_with(&self.module.types))
    }

    fn paths(&self, ty: &TypeInner) -> Vec<Path> {
        let below = |i: u32, ty: Handle<naga::Type>| {
            self.paths(&self.module.types[ty].inner).into_iter().map(move |path| [&[i], &path[..]].concat())
        };
        match ty {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => vec![vec![]],
            TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => {
                (0..*size as u32).map(|i| vec![i]).collect()
            }
            TypeInner::Struct { members, .. } => (0..).zip(members).flat_map(|(i, m)| below(i, m.ty)).collect(),
            TypeInner::Array { base, size: naga::ArraySize::Constant(size), .. } => {
                (0..size.get()).flat_map(|i| below(i, *base)).collect()
            }
            TypeInner::Matrix { .. } => panic!("matrices: teach this test what to make of them"),
            _ => vec![],
        }
    }

    fn is_float(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> bool {
        let ty = frame.info[handle].ty.inner_with(&self.module.types);
        matches!(ty, TypeInner::Scalar(_) | TypeInner::Vector { .. }) && !self.paths(ty).is_empty()
    }

    /// All choices of what is taken out of variables that sums or products are kept in: as a number of its own, or what
    /// was put in at one place.
    fn choices(&self) -> Vec<Choice> {
        let mut worth: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        loop {
            let before: usize = worth.values().map(Vec::len).sum();
            for (i, kept) in self.kept.iter().enumerate() {
                let Some((variable, _)) = self.variable(&kept.frame, kept.pointer) else { continue };
                if self.is_computed(&kept.frame, kept.value, &worth) {
                    let places = worth.entry(variable).or_default();
                    if !places.contains(&i) {
                        places.push(i);
                    }
                }
            }
            if worth.values().map(Vec::len).sum::<usize>() == before {
                break;
            }
        }
        let mut choices = vec![Choice::new()];
        for (variable, places) in worth {
            let with = |choice: &Choice, place| {
                let mut choice = choice.clone();
                choice.insert(variable.clone(), place);
                choice
            };
            let more: Vec<_> = choices.iter().flat_map(|c| places.iter().map(move |&p| with(c, p))).collect();
            choices.extend(more);
        }
        choices
    }

    /// Whether there is a sum or product in a value, or in what is kept in a variable that it takes it from.
    fn is_computed(&self, frame: &Frame<'m>, handle: Handle<Expression>, worth: &BTreeMap<String, Vec<usize>>) -> bool {
        let is_computed = |handle| self.is_computed(frame, handle, worth);
        match &frame.function.expressions[handle] {
            Expression::Binary { .. } | Expression::Unary { .. } | Expression::Math { .. } => {
                let paths = self.components(frame, handle);
                let none = Choice::new();
                paths.iter().any(|path| matches!(self.tree(frame, handle, path, &none), Tree::Operation(..)))
            }
            Expression::Compose { components, .. } => components.iter().any(|&c| is_computed(c)),
            Expression::AccessIndex { base, .. } => is_computed(*base),
            Expression::Swizzle { vector, .. } => is_computed(*vector),
            Expression::FunctionArgument(i) => {
                frame.caller.as_ref().is_some_and(|(caller, given)| self.is_computed(caller, given[*i as usize], worth))
            }
            Expression::CallResult(_) => {
                let called = &self.calls[&(frame.number, handle.index())];
                returned(called).is_some_and(|value| self.is_computed(called, value, worth))
            }
            Expression::Load { pointer } => {
                self.variable(frame, *pointer).is_some_and(|(variable, _)| worth.contains_key(&variable))
            }
            _ => false,
        }
    }

    /// The variable of the invocation's own that a pointer leads into, and the path there, elements of arrays left out.
    fn variable(&self, frame: &Frame<'m>, pointer: Handle<Expression>) -> Option<(String, Path)> {
        match &frame.function.expressions[pointer] {
            Expression::AccessIndex { base, index } => {
                let (variable, mut path) = self.variable(frame, *base)?;
                path.push(*index);
                Some((variable, path))
            }
            Expression::Access { base, .. } => self.variable(frame, *base),
            Expression::LocalVariable(_) => Some((self.name(frame, pointer), vec![])),
            Expression::GlobalVariable(global) => {
                let is_own = self.module.global_variables[*global].space == naga::AddressSpace::Private;
                is_own.then(|| (self.name(frame, pointer), vec![]))
            }
            _ => None,
        }
    }

    /// The tree of the f32 at `path` in an expression.
    fn tree(&self, frame: &Frame<'m>, handle: Handle<Expression>, path: &[u32], choice: &Choice) -> Tree {
        let leaf = || Tree::Leaf(format!("{}{path:?}", self.name(frame, handle)));
        // Operands that are no vectors count for each component.
        let operand = |handle: Handle<Expression>| {
            let is_vector = matches!(frame.info[handle].ty.inner_with(&self.module.types), TypeInner::Vector { .. });
            self.tree(frame, handle, if is_vector { path } else { &[] }, choice)
        };
        let is_float = self.is_float(frame, handle);
        match &frame.function.expressions[handle] {
            Expression::Binary { op, left, right } if is_float => {
                let sign = match op {
                    BinaryOperator::Add => "+",
                    BinaryOperator::Subtract => "-",
                    BinaryOperator::Multiply => "*",
                    BinaryOperator::Divide => "/",
                    other => panic!("{other:?}: teach this test what to make of it"),
                };
                Tree::Operation(sign, vec![operand(*left), operand(*right)])
            }
            Expression::Unary { op: UnaryOperator::Negate, expr } if is_float => {
                Tree::Operation("-", vec![operand(*expr)])
            }
            // These give one of their arguments, but for its sign.
            Expression::Math { fun: MathFunction::Min | MathFunction::Max | MathFunction::Abs, .. } => leaf(),
            Expression::Math { fun, .. } if is_float => panic!("{fun:?}: teach this test what to make of it"),
            Expression::Compose { components, .. } => match path.split_first() {
                Some((first, rest)) if components.len() > *first as usize => {
                    self.tree(frame, components[*first as usize], rest, choice)
                }
                _ => leaf(),
            },
            Expression::Splat { value, .. } => self.tree(frame, *value, &[], choice),
            Expression::AccessIndex { base, index } => self.tree(frame, *base, &[&[*index], path].concat(), choice),
            Expression::Swizzle { vector, pattern, .. } => {
                self.tree(frame, *vector, &[pattern[path[0] as usize] as u32], choice)
            }
            Expression::FunctionArgument(i) => match &frame.caller {
                Some((caller, given)) => self.tree(caller, given[*i as usize], path, choice),
                None => leaf(),
            },
            Expression::CallResult(_) => {
                let called = &self.calls[&(frame.number, handle.index())];
                returned(called).map_or_else(leaf, |value| self.tree(called, value, path, choice))
            }
            Expression::Load { pointer } => self.taken(frame, *pointer, path, choice).unwrap_or_else(leaf),
            _ => leaf(),
        }
    }

    /// What was put into the variable that is read, by the choice.
    fn taken(&self, frame: &Frame<'m>, pointer: Handle<Expression>, path: &[u32], choice: &Choice) -> Option<Tree> {
        let (variable, place) = self.variable(frame, pointer)?;
        let kept = &self.kept[*choice.get(&variable)?];
        let (_, into) = self.variable(&kept.frame, kept.pointer)?;
        let whole = [&place[..], path].concat();
        let rest = whole.strip_prefix(&into[..])?;
        // Nothing is followed round in a circle.
        let mut choice = choice.clone();
        choice.remove(&variable);
        let mut tree = self.tree(&kept.frame, kept.value, rest, &choice);
        rename(&mut tree, &variable);
        Some(tree)
    }

    /// What a value is, the same for the same value: a `~` marks what is different each time that a loop comes by.
    fn name(&self, frame: &Frame<'m>, handle: Handle<Expression>) -> String {
        let name = |handle| self.name(frame, handle);
        match &frame.function.expressions[handle] {
            Expression::FunctionArgument(i) => match &frame.caller {
                Some((caller, given)) => self.name(caller, given[*i as usize]),
                None => format!("argument {i}"),
            },
            Expression::GlobalVariable(v) => self.module.global_variables[*v].name.clone().unwrap(),
            Expression::LocalVariable(v) => {
                format!("~{}", frame.function.local_variables[*v].name.clone().unwrap_or_else(|| format!("{v:?}")))
            }
            Expression::AccessIndex { base, index } => format!("{}.{index}", name(*base)),
            Expression::Access { base, index } => format!("{}[{}]", name(*base), name(*index)),
            Expression::Load { pointer } => format!("*{}", name(*pointer)),
            Expression::Binary { op, left, right } => format!("({} {op:?} {})", name(*left), name(*right)),
            Expression::Literal(literal) => format!("{literal:?}"),
            _ => format!("{}~{}", frame.number, handle.index()),
        }
    }
}

fn is_arithmetic(op: BinaryOperator) -> bool {
    use BinaryOperator::{Add, Divide, Modulo, Multiply, Subtract};
    matches!(op, Add | Subtract | Multiply | Divide | Modulo)
}

/// The value of a function that has no more to it than that.
fn returned(frame: &Frame<'_>) -> Option<Handle<Expression>> {
    let mut value = None;
    for statement in frame.function.body.iter() {
        match statement {
            Statement::Emit(_) | Statement::Call { .. } => {}
            Statement::Return { value: found } => value = *found,
            _ => return None,
        }
    }
    value
}

/// What is different each time is another number where it comes out of a variable.
fn rename(tree: &mut Tree, variable: &str) {
    match tree {
        Tree::Leaf(name) if name.contains('~') => *name = format!("{variable}:{name}"),
        Tree::Leaf(_) => {}
        Tree::Operation(_, parts) => parts.iter_mut().for_each(|part| rename(part, variable)),
    }
}
