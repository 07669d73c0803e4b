//! Checks the text of a Wavefront OBJ file line by line, so that every fault has its place.

/// Largest coordinate, as for every coordinate of a scene.
const FARTHEST: f64 = 1e12;

/// A fault in one line of the text.
pub(super) struct Fault {
    /// Counted from 1.
    pub(super) line: usize,
    /// Characters, counted from 1.
    pub(super) column: usize,
    /// What is wrong.
    pub(super) cause: String,
    /// A way out.
    pub(super) way_out: &'static str,
}

/// What every corner of a triangle has.
#[derive(Clone, Copy)]
pub(super) struct Corners {
    /// A normal at every corner.
    pub(super) normals: bool,
    /// Texture coordinates at every corner.
    pub(super) uvs: bool,
}

/// The text checked line by line, because the parser behind it names no lines, fills in missing
/// normals from other corners, and takes lines of more than two points for faces.
pub(super) struct Scan {
    /// Only `v`, `vt`, `vn` and `f`, without groups, vertex colours and comments.
    pub(super) clean: String,
    /// For every triangle to come.
    pub(super) triangles: Vec<Corners>,
}

/// How many `v`, `vt` and `vn` there are.
type Counts = [usize; 3];

/// A word and the line it stands in.
#[derive(Clone, Copy)]
struct Word<'a> {
    text: &'a str,
    line: &'a str,
    line_number: usize,
}

impl Word<'_> {
    fn fault(&self, cause: String, way_out: &'static str) -> Fault {
        let offset = self.text.as_ptr() as usize - self.line.as_ptr() as usize;
        let column = self.line[..offset].chars().count() + 1;
        Fault { line: self.line_number, column, cause, way_out }
    }

    fn number(&self) -> Result<f64, Fault> {
        let Ok(x) = self.text.parse::<f64>() else {
            let cause = format!("`{}` is not a number", self.text);
            return Err(self.fault(cause, "write numbers such as 0.5 or -1e-3"));
        };
        if !x.is_finite() {
            let cause = format!("`{}` is not a finite number", self.text);
            return Err(self.fault(cause, "export the model again, without empty or broken points"));
        }
        Ok(x)
    }
}

impl Scan {
    /// Checks a whole text; the first fault ends it.
    pub(super) fn of(source: &str) -> Result<Scan, Fault> {
        let mut totals = Counts::default();
        for line in source.lines() {
            if let Some(list) = list_of(line.split_whitespace().next().unwrap_or_default()) {
                totals[list] += 1;
            }
        }
        let mut scan = Scan { clean: String::with_capacity(source.len()), triangles: Vec::new() };
        let mut seen = Counts::default();
        for (index, line) in source.lines().enumerate() {
            let code = line.split('#').next().unwrap_or_default();
            let words: Vec<Word<'_>> = code
                .split_whitespace()
                .map(|text| Word { text, line, line_number: index + 1 })
                .collect();
            let Some((first, rest)) = words.split_first() else { continue };
            match list_of(first.text) {
                Some(list) => {
                    scan.vertex(list, first, rest)?;
                    seen[list] += 1;
                }
                None if first.text == "f" => scan.face(first, rest, seen, totals)?,
                None => {}
            }
        }
        Ok(scan)
    }

    /// Checks and copies `v x y z [w | r g b]`, `vt u [v [w]]` or `vn x y z`.
    fn vertex(&mut self, list: usize, first: &Word<'_>, rest: &[Word<'_>]) -> Result<(), Fault> {
        let wanted = if list == 1 { 1 } else { 3 };
        if rest.len() < wanted {
            let cause = format!("`{}` needs {wanted} numbers, found {}", first.text, rest.len());
            return Err(first.fault(cause, "add the missing numbers"));
        }
        let kept = match (list, rest.len()) {
            (0, 4) => 4,
            (1, count) => count.min(2),
            _ => 3,
        };
        let numbers: Vec<f64> = rest[..kept].iter().map(Word::number).collect::<Result<_, _>>()?;
        let weight = numbers.get(3).copied().unwrap_or(1.0);
        if weight == 0.0 {
            let cause = "the weight of the point is zero".to_owned();
            return Err(rest[3].fault(cause, "leave the fourth number out"));
        }
        let far = numbers.iter().take(3).position(|x| (x / weight).abs() > FARTHEST);
        if let Some(far) = far.filter(|_| list == 0) {
            let cause = format!("the coordinate `{}` is beyond {FARTHEST:e}", rest[far].text);
            return Err(rest[far].fault(cause, "use a larger unit of length"));
        }
        self.copy(first, &rest[..kept], if list == 1 && kept == 1 { " 0\n" } else { "\n" });
        Ok(())
    }

    /// Checks and copies `f v v v`, `f v/vt …`, `f v//vn …` or `f v/vt/vn …`.
    fn face(
        &mut self,
        first: &Word<'_>,
        rest: &[Word<'_>],
        seen: Counts,
        totals: Counts,
    ) -> Result<(), Fault> {
        if rest.len() < 3 {
            let cause = format!("a face needs at least 3 corners, this one has {}", rest.len());
            return Err(first.fault(cause, "add corners, or leave the face out"));
        }
        let mut all = Corners { normals: true, uvs: true };
        for corner in rest {
            let here = check_corner(corner, seen, totals)?;
            all.normals &= here.normals;
            all.uvs &= here.uvs;
        }
        self.triangles.extend((2..rest.len()).map(|_| all));
        self.copy(first, rest, "\n");
        Ok(())
    }

    fn copy(&mut self, first: &Word<'_>, rest: &[Word<'_>], end: &str) {
        self.clean.push_str(first.text);
        for word in rest {
            self.clean.push(' ');
            self.clean.push_str(word.text);
        }
        self.clean.push_str(end);
    }
}

/// The list that a line with this first word adds to.
fn list_of(word: &str) -> Option<usize> {
    ["v", "vt", "vn"].iter().position(|key| *key == word)
}

/// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative indices count back from the last line read.
fn check_corner(word: &Word<'_>, seen: Counts, totals: Counts) -> Result<Corners, Fault> {
    const NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];
    let mut has = [false; 3];
    for (list, text) in word.text.split('/').enumerate() {
        if list < 3 && text.is_empty() && list > 0 {
            continue;
        }
        let (Some(name), Ok(index)) = (NAMES.get(list), text.parse::<i64>()) else {
            let cause = format!("`{}` is not a corner", word.text);
            return Err(word.fault(cause, "write corners as 1, 1/2, 1//3 or 1/2/3"));
        };
        let count = if index < 0 { seen[list] } else { totals[list] };
        if index == 0 || index.unsigned_abs() > count as u64 {
            let so_far = if index < 0 { " so far" } else { "" };
            let cause = format!("there is no {name} {index}; the file has {count}{so_far}");
            return Err(word.fault(cause, "count from 1, or from -1 backwards"));
        }
        has[list] = true;
    }
    Ok(Corners { uvs: has[1], normals: has[2] })
}
