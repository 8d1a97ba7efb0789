//! Tables as text: cells to lines (RFC 4180), and back.

/// A line of CSV (RFC 4180): cells with commas, quotes or line breaks stand in quotes, quotes in them doubled.
pub(crate) fn csv_line<S: AsRef<str>>(cells: &[S]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| csv_cell(cell.as_ref())).collect();
    cells.join(",") + "\n"
}

fn csv_cell(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// The records of a CSV text (RFC 4180) that are whole, with the line in which each begins.
pub(crate) fn records(text: &str) -> Vec<(usize, Vec<String>)> {
    let (mut records, mut cells, mut cell) = (Vec::new(), Vec::new(), String::new());
    let (mut line, mut begins, mut quoted) = (1, 1, false);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        line += usize::from(character == '\n');
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => cell.extend(characters.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                cells.push(std::mem::take(&mut cell));
                records.push((begins, std::mem::take(&mut cells)));
                begins = line;
            }
            other => cell.push(other),
        }
    }
    records
}

#[cfg(test)]
mod tests {
    use super::{csv_line, records};

    #[test]
    fn cells_that_need_quotes_have_them() {
        assert_eq!(
            csv_line(&["plain", "a, b", "say \"no\"", "two\nlines", ""]),
            "plain,\"a, b\",\"say \"\"no\"\"\",\"two\nlines\",\n"
        );
    }

    #[test]
    fn records_read_back_and_half_ones_are_dropped() {
        let cells = [vec!["plain", "a, b", "say \"no\""], vec!["two\nlines", "", "end"]];
        let text: String = cells.iter().map(|cells| csv_line(cells)).collect();
        let read = records(&text);
        assert_eq!(read.iter().map(|(_, cells)| cells.clone()).collect::<Vec<_>>(), cells);
        assert_eq!(read.iter().map(|(line, _)| *line).collect::<Vec<_>>(), [1, 2]);
        for end in text.char_indices().map(|(at, _)| at).skip(1) {
            let expected = usize::from(end > csv_line(&cells[0]).len() - 1);
            assert_eq!(records(&text[..end]).len(), expected, "{:?}", &text[..end]);
        }
    }
}
