//! Matrix Market files (Boisvert, Pozo & Remington 1996): real matrices, coordinate or array.

use nalgebra::DMatrix;

use super::file::{At, LcpFileError, MOST_UNKNOWNS};

/// What the header promises.
#[derive(Clone, Copy)]
struct Header {
    coordinate: bool,
    /// Sign of the mirrored entry, if only the lower triangle is given.
    mirror: Option<f64>,
}

/// Reads a dense matrix from the text of a file.
///
/// # Errors
/// An [`LcpFileError`] that names file and line.
pub(super) fn matrix_of(at: &At<'_>, text: &str) -> Result<DMatrix<f64>, LcpFileError> {
    let mut lines = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    let header = header(at, lines.next().map_or("", |(_, line)| line))?;
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('%'));
    let (line, size) = lines.next().ok_or_else(|| {
        at.field("size", "missing", "the first line after the comments is `rows columns [entries]`")
    })?;
    let size: Vec<usize> = numbers(at, line, size)?;
    let expected = if header.coordinate { 3 } else { 2 };
    if size.len() != expected {
        let found = format!("{} numbers", size.len());
        return Err(at.field(&format!("line {line}"), &found, "give `rows columns [entries]`"));
    }
    if size[0].max(size[1]) > MOST_UNKNOWNS {
        let remedy = format!("matrices are dense here; at most {MOST_UNKNOWNS} rows and columns");
        return Err(at.field(&format!("line {line}"), "too large", &remedy));
    }
    if header.mirror.is_some() && size[0] != size[1] {
        let found = format!("{} rows, {} columns", size[0], size[1]);
        return Err(at.field(&format!("line {line}"), &found, "a symmetric matrix is square"));
    }
    let mut matrix = DMatrix::zeros(size[0], size[1]);
    let mut places = places(header, size[0], size[1]);
    let mut count = 0;
    for (line, text) in lines {
        let (i, j, value) = if header.coordinate {
            coordinate(at, line, text, &size)?
        } else {
            let value = numbers(at, line, text)?;
            let (Some((i, j)), [value]) = (places.next(), &value[..]) else {
                return Err(at.field(&format!("line {line}"), text, "one number per entry"));
            };
            (i, j, *value)
        };
        if i == j && header.mirror == Some(-1.0) {
            let remedy = "the diagonal of a skew-symmetric matrix is zero; leave it out";
            return Err(at.field(&format!("line {line}"), text, remedy));
        }
        matrix[(i, j)] += value;
        if let Some(sign) = header.mirror.filter(|_| i != j) {
            matrix[(j, i)] += sign * value;
        }
        count += 1;
    }
    let expected = if header.coordinate { size[2] } else { count + places.count() };
    if count == expected {
        return Ok(matrix);
    }
    let (found, remedy) = (format!("{count} entries"), format!("the size line says {expected}"));
    Err(at.field("entries", &found, &remedy))
}

fn header(at: &At<'_>, line: &str) -> Result<Header, LcpFileError> {
    let words: Vec<String> = line.split_whitespace().map(str::to_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let remedy = "start with `%%MatrixMarket matrix coordinate real general`, or `array` for \
                  `coordinate`, `integer` for `real`, `symmetric` or `skew-symmetric` for `general`";
    let ["%%matrixmarket", "matrix", format, "real" | "integer" | "double", symmetry] = words[..]
    else {
        return Err(at.field("line 1", line, remedy));
    };
    let mirror = match symmetry {
        "general" => None,
        "symmetric" => Some(1.0),
        "skew-symmetric" => Some(-1.0),
        _ => return Err(at.field("line 1", line, remedy)),
    };
    match format {
        "coordinate" => Ok(Header { coordinate: true, mirror }),
        "array" => Ok(Header { coordinate: false, mirror }),
        _ => Err(at.field("line 1", line, remedy)),
    }
}

/// The entries of an array file, column by column.
fn places(header: Header, rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    let first = move |j: usize| match header.mirror {
        None => 0,
        Some(sign) if sign > 0.0 => j,
        Some(_) => j + 1,
    };
    (0..columns).flat_map(move |j| (first(j)..rows).map(move |i| (i, j)))
}

fn coordinate(
    at: &At<'_>,
    line: usize,
    text: &str,
    size: &[usize],
) -> Result<(usize, usize, f64), LcpFileError> {
    let value: Vec<f64> = numbers(at, line, text)?;
    let places: Vec<usize> =
        text.split_whitespace().take(2).filter_map(|word| word.parse().ok()).collect();
    match (&places[..], &value[..]) {
        (&[i, j], &[_, _, value]) if (1..=size[0]).contains(&i) && (1..=size[1]).contains(&j) => {
            Ok((i - 1, j - 1, value))
        }
        _ => {
            let remedy =
                format!("give `row column value`, counted from 1 to {} {}", size[0], size[1]);
            Err(at.field(&format!("line {line}"), text, &remedy))
        }
    }
}

fn numbers<T: std::str::FromStr>(
    at: &At<'_>,
    line: usize,
    text: &str,
) -> Result<Vec<T>, LcpFileError> {
    let word = |word: &str| {
        word.parse().map_err(|_| at.field(&format!("line {line}"), word, "give a number"))
    };
    text.split_whitespace().map(word).collect()
}
