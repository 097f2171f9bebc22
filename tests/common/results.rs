//! Reads results of the program: tables, JSON, data of pages, pictures.

use std::fs;
use std::ops::Index;
use std::path::Path;
use std::sync::Arc;

use nalgebra::Vector2;
use roxmltree::{Document, Node};
use serde_json::Value;

/// A table of comma-separated values.
pub struct Table {
    pub header: Arc<Vec<String>>,
    pub rows: Vec<Row>,
}

impl Table {
    pub fn read(path: impl AsRef<Path>) -> Self {
        Self::parse(fs::read(path).unwrap())
    }

    pub fn parse(text: impl AsRef<[u8]>) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_ref());
        let words = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let header = Arc::new(words(reader.headers().unwrap()));
        let rows = reader.records().map(|record| Row {
            header: Arc::clone(&header),
            cells: words(&record.unwrap()),
        });
        Self {
            rows: rows.collect(),
            header,
        }
    }

    pub fn numbers(&self, column: &str) -> Vec<f64> {
        self.rows.iter().map(|row| row.number(column)).collect()
    }
}

/// A row of a table: its cells by the names of their columns, or by number.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    header: Arc<Vec<String>>,
    cells: Vec<String>,
}

impl Row {
    #[track_caller]
    pub fn number<Column>(&self, column: Column) -> f64
    where
        Self: Index<Column, Output = String>,
    {
        self[column].parse().unwrap()
    }

    /// Names of columns, with the cells in them.
    pub fn cells(&self) -> impl Iterator<Item = (&str, &str)> {
        let names = self.header.iter().map(String::as_str);
        names.zip(self.cells.iter().map(String::as_str))
    }
}

impl Index<usize> for Row {
    type Output = String;
    fn index(&self, column: usize) -> &String {
        &self.cells[column]
    }
}

impl<Name: AsRef<str> + ?Sized> Index<&Name> for Row {
    type Output = String;
    #[track_caller]
    fn index(&self, column: &Name) -> &String {
        let column = column.as_ref();
        let found = self.header.iter().position(|name| name == column);
        let found = found.unwrap_or_else(|| panic!("no {column} in {:?}", self.header));
        &self.cells[found]
    }
}

pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

pub fn summary(folder: &Path) -> Value {
    json(&folder.join("summary.json"))
}

/// The data that a page draws.
pub fn data_of(page: &str) -> Value {
    let (_, after) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(after.split_once("</script>").unwrap().0).unwrap()
}

/// The marks of this name in a picture.
pub fn named<'a>(picture: &'a Document<'a>, name: &str) -> Vec<Node<'a, 'a>> {
    let marks = picture.descendants();
    marks
        .filter(|node| node.attribute("data-name") == Some(name))
        .collect()
}

pub fn number(mark: &Node<'_, '_>, attribute: &str) -> f64 {
    mark.attribute(attribute).unwrap().parse().unwrap()
}

/// The strokes of a path of straight lines: lines, or the corners of polygons.
pub fn strokes(mark: &Node<'_, '_>) -> Vec<Vec<Vector2<f64>>> {
    let path = mark.attribute("d").unwrap();
    let strokes = path.split('M').skip(1);
    let points = |stroke: &str| {
        let numbers = stroke.split(['L', ' ', ',', 'Z']);
        let numbers: Vec<f64> = numbers
            .filter(|text| !text.is_empty())
            .map(|text| text.parse().unwrap())
            .collect();
        let pairs = numbers.chunks_exact(2);
        pairs.map(|xy| Vector2::new(xy[0], xy[1])).collect()
    };
    strokes.map(points).collect()
}

/// The points of a path of one stroke.
pub fn points(mark: &Node<'_, '_>) -> Vec<Vector2<f64>> {
    let mut strokes = strokes(mark);
    assert_eq!(strokes.len(), 1, "one stroke");
    strokes.remove(0)
}

pub fn texts(picture: &Document<'_>) -> Vec<String> {
    let nodes = picture.descendants();
    nodes
        .filter_map(|node| node.text().filter(|_| node.has_tag_name("text")))
        .map(str::to_owned)
        .collect()
}
