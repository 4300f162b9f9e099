//! The layout of result.json.

use std::io::{self, Write};

use serde_json::ser::Formatter;

/// One name a line, arrays on one line, and a refusal to write `null`.
#[derive(Default)]
pub(super) struct Layout {
    /// Where in the file we are.
    path: Vec<Step>,
    in_name: bool,
    /// The object at hand has a member.
    has_member: bool,
}

enum Step {
    Name(String),
    Index(usize),
}

impl Layout {
    fn new_line<W: ?Sized + Write>(&self, to: &mut W) -> io::Result<()> {
        write!(to, "\n{:width$}", "", width = 2 * self.path.len())
    }

    fn place(&self) -> String {
        let mut place = String::new();
        for step in &self.path {
            match step {
                Step::Name(name) if place.is_empty() => place.push_str(name),
                Step::Name(name) => place.extend([".", name]),
                Step::Index(i) => place.push_str(&format!("[{i}]")),
            }
        }
        place
    }
}

impl Formatter for Layout {
    /// serde_json comes here for a NaN or an infinity.
    fn write_null<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        Err(io::Error::other(self.place()))
    }

    fn begin_array<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.path.push(Step::Index(0));
        to.write_all(b"[")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        if first {
            return Ok(());
        }
        if let Some(Step::Index(i)) = self.path.last_mut() {
            *i += 1;
        }
        to.write_all(b", ")
    }

    fn end_array<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.path.pop();
        to.write_all(b"]")
    }

    fn begin_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        self.has_member = false;
        to.write_all(b"{")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        if !first {
            to.write_all(b",")?;
        }
        self.path.push(Step::Name(String::new()));
        self.in_name = true;
        self.new_line(to)
    }

    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        to: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        if let (true, Some(Step::Name(name))) = (self.in_name, self.path.last_mut()) {
            name.push_str(fragment);
        }
        to.write_all(fragment.as_bytes())
    }

    fn end_object_key<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        self.in_name = false;
        Ok(())
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        to.write_all(b": ")
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        self.path.pop();
        self.has_member = true;
        Ok(())
    }

    fn end_object<W: ?Sized + Write>(&mut self, to: &mut W) -> io::Result<()> {
        if self.has_member {
            self.new_line(to)?;
        }
        to.write_all(b"}")
    }
}
