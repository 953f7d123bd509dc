//! Which source files import from which, read from their `use` lines and paths.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A place in the tree of modules, without the crate: `["gpu", "pages"]`.
pub(super) type Module = Vec<String>;

/// From each file to the files from which it imports, and the names that it takes from there.
pub(super) type Imports = BTreeMap<Module, BTreeMap<Module, BTreeSet<String>>>;

/// The library and the command line, as one tree of modules. What the file of the binary itself imports is left out.
pub(super) struct House {
    files: BTreeMap<Module, File>,
}

/// One file, without its tests.
#[derive(Default)]
struct File {
    uses: Vec<Use>,
    /// The words and marks outside of `use` lines.
    body: Vec<String>,
    /// The modules that it declares for tests only.
    tests: Vec<String>,
}

/// One name of a `use` line.
struct Use {
    path: Vec<String>,
    name: String,
    is_public: bool,
}

impl House {
    /// Reads all files under `src`.
    pub(super) fn read(src: &Path) -> House {
        let mut files = BTreeMap::new();
        for path in super::sources(src) {
            let module = path.strip_prefix(src).expect("under src").with_extension("");
            let mut module: Module = module.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            match module.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                ["main"] | ["build"] => continue,
                [.., "mod"] | ["lib"] => drop(module.pop()),
                _ => {}
            }
            files.insert(module, File::of(&std::fs::read_to_string(path).expect("a source file is read")));
        }
        let is_test = |module: &Module, files: &BTreeMap<Module, File>| {
            (1..=module.len()).any(|n| files.get(&module[..n - 1]).is_some_and(|f| f.tests.contains(&module[n - 1])))
        };
        let tests: Vec<Module> = files.keys().filter(|module| is_test(module, &files)).cloned().collect();
        tests.iter().for_each(|module| drop(files.remove(module)));
        House { files }
    }

    /// Who imports from whom. A name that a module passes on counts as one of the file that defines it.
    pub(super) fn imports(&self) -> Imports {
        self.files.keys().map(|module| (module.clone(), self.imports_of(module))).collect()
    }

    fn imports_of(&self, module: &Module) -> BTreeMap<Module, BTreeSet<String>> {
        let file = &self.files[module];
        let mut found: BTreeMap<Module, BTreeSet<String>> = BTreeMap::new();
        // A module alone says nothing: what is taken from it stands where it is used.
        let mut take = |path: &[String]| {
            if let Some(whole) = self.whole(module, path)
                && !self.files.contains_key(&whole)
                && let Some(from) = self.origin(&whole)
                && from != *module
            {
                found.entry(from).or_default().insert(path.last().expect("a path has a name").clone());
            }
        };
        for Use { path, name, is_public } in &file.uses {
            // What is only passed on is no import of its own.
            if !is_public || file.body.contains(name) {
                take(path);
            }
        }
        let mut i = 0;
        while i < file.body.len() {
            let start = i;
            while let [word, "::", next, ..] = [0, 1, 2].map(|n| file.body.get(i + n).map_or("", String::as_str))
                && is_word(word)
                && is_word(next)
            {
                i += 2;
            }
            let path: Vec<String> = file.body[start..=i].iter().step_by(2).cloned().collect();
            if path.len() > 1 {
                take(&path);
            }
            i += 1;
        }
        found
    }

    /// A path as it stands in `module`, from the crate on; `None` if it leads out of it.
    fn whole(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut base = module.to_vec();
        let (first, mut rest) = path.split_first()?;
        match first.as_str() {
            "crate" | "tautline" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                while rest.first().is_some_and(|part| part == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            name => {
                base.push(name.to_owned());
                if !self.files.contains_key(&base) {
                    let used = self.files[module].uses.iter().find(|used| used.name == name && used.path != path)?;
                    base = self.whole(module, &used.path).filter(|whole| self.files.contains_key(whole))?;
                }
            }
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// The file that defines what `whole` leads to.
    fn origin(&self, whole: &[String]) -> Option<Module> {
        let module = (0..=whole.len()).rev().map(|n| &whole[..n]).find(|part| self.files.contains_key(*part))?;
        let Some((name, rest)) = whole[module.len()..].split_first() else { return Some(module.to_vec()) };
        let passed_on = self.files[module].uses.iter().find(|used| used.name == *name);
        match passed_on.and_then(|used| self.whole(module, &used.path)) {
            Some(path) if path != whole => self.origin(&[&path, rest].concat()),
            _ => Some(module.to_vec()),
        }
    }
}

impl File {
    fn of(text: &str) -> File {
        let mut file = File::default();
        let words = words(text);
        let mut i = 0;
        while i < words.len() {
            if words[i..].starts_with(&["#", "[", "cfg", "(", "test", ")", "]"].map(str::to_owned)) {
                i += 7;
                if words[i] == "mod" {
                    file.tests.push(words[i + 1].clone());
                }
                i += item_len(&words[i..]);
            } else if words[i] == "use" && words[i + 1] != "<" {
                let is_public = i > 0 && (words[i - 1] == "pub" || words[i - 1] == ")");
                let end = i + words[i..].iter().position(|word| word == ";").expect("a use line ends");
                for path in use_tree(&words[i + 1..end]) {
                    let (path, name) = match path.iter().position(|word| word == "as") {
                        Some(at) => (path[..at].to_vec(), path[at + 1].clone()),
                        None => (path.clone(), path[path.len() - 1].clone()),
                    };
                    file.uses.push(Use { path, name, is_public });
                }
                i = end;
            } else {
                file.body.push(words[i].clone());
                i += 1;
            }
        }
        file
    }
}

/// How many words the item takes with which `words` begin.
fn item_len(words: &[String]) -> usize {
    let mut depth = 0;
    for (i, word) in words.iter().enumerate() {
        depth += i32::from(word == "{") - i32::from(word == "}");
        if depth == 0 && (word == ";" || word == "}") {
            return i + 1;
        }
    }
    words.len()
}

/// All paths of what stands between `use` and `;`, without their `::`.
fn use_tree(words: &[String]) -> Vec<Vec<String>> {
    let Some(open) = words.iter().position(|word| word == "{") else {
        return vec![words.iter().filter(|word| *word != "::").cloned().collect()];
    };
    let head: Vec<String> = words[..open].iter().filter(|word| *word != "::").cloned().collect();
    let (mut depth, mut start, mut paths) = (0, open + 1, Vec::new());
    for i in open..words.len() {
        depth += i32::from(words[i] == "{") - i32::from(words[i] == "}");
        if (depth == 1 && words[i] == "," || depth == 0) && start < i {
            paths.extend(use_tree(&words[start..i]).into_iter().map(|mut tail| {
                if tail == ["self"] {
                    tail.clear();
                }
                [head.clone(), tail].concat()
            }));
        }
        if depth == 1 && words[i] == "," {
            start = i + 1;
        }
    }
    paths
}

fn is_word(word: &str) -> bool {
    word.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The words and marks of a source text, without comments and literals.
fn words(text: &str) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let len = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(len) = literal_len(rest) {
            len
        } else if is_word(rest) {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        let (word, after) = rest.split_at(len);
        let is_left_out = first.is_whitespace() || word.starts_with("//") || literal_len(rest).is_some();
        if !is_left_out {
            words.push(word.to_owned());
        }
        rest = after;
    }
    words
}

/// How long the string or character is with which `text` begins.
fn literal_len(text: &str) -> Option<usize> {
    let body = text.strip_prefix('b').unwrap_or(text);
    let before = text.len() - body.len();
    if let Some(raw) = body.strip_prefix('r') {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        if raw[hashes..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(hashes));
            let found = raw[hashes + 1..].find(&end).expect("a string ends");
            return Some(before + 1 + hashes + 1 + found + end.len());
        }
    }
    let quote = body.chars().next().filter(|c| *c == '"' || *c == '\'')?;
    // A lifetime has no second quote.
    if quote == '\'' && !body[1..].starts_with('\\') && body[1..].chars().nth(1) != Some('\'') {
        return None;
    }
    let mut is_escaped = false;
    for (i, c) in body.char_indices().skip(1) {
        if !is_escaped && c == quote {
            return Some(before + i + 1);
        }
        is_escaped = !is_escaped && c == '\\';
    }
    None
}
