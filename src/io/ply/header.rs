//! The header of a PLY file: its encoding, and the elements with their properties.

/// Longest header, bytes.
const LONGEST: usize = 1 << 16;

/// How the numbers of a file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A kind of number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Returns the kind with a name in a header.
    fn named(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return Err(format!("there is no type {name:?}")),
        })
    }

    /// Returns its size in a binary file, bytes.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }
}

/// A property of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Property {
    pub name: String,
    /// Kind of the length of a list; none for a single value.
    pub length: Option<Scalar>,
    /// Kind of the value, or of the list's values.
    pub value: Scalar,
}

/// An element: so many rows of the same properties.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// The header of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
}

impl Header {
    /// Parses the header of a file, and returns what follows it.
    ///
    /// # Errors
    /// With the line of a mistake.
    pub fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let (mut encoding, mut elements, mut rest) = (None, Vec::<Element>::new(), bytes);
        for number in 1.. {
            let end = memchr::memchr(b'\n', rest).ok_or("its header has no end")?;
            let (line, behind) = rest.split_at(end);
            rest = &behind[1..];
            if bytes.len() - rest.len() > LONGEST {
                return Err("its header has no end".to_owned());
            }
            let bad = |what: &str| format!("line {number}: {what}");
            let line = std::str::from_utf8(line).map_err(|_| bad("it is no text"))?;
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                ["ply"] if number == 1 => {}
                _ if number == 1 => return Err("it does not begin with the word ply".to_owned()),
                ["end_header"] => break,
                [] | ["comment" | "obj_info", ..] => {}
                ["format", "ascii", _] => encoding = Some(Encoding::Text),
                ["format", "binary_little_endian", _] => encoding = Some(Encoding::LittleEndian),
                ["format", "binary_big_endian", _] => encoding = Some(Encoding::BigEndian),
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| bad("an element needs a number of rows"))?;
                    elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
                }
                ["property", "list", length, value, name] => {
                    let length = Some(Scalar::named(length).map_err(|what| bad(&what))?);
                    add(&mut elements, name, length, value).map_err(|what| bad(&what))?;
                }
                ["property", value, name] => add(&mut elements, name, None, value).map_err(|what| bad(&what))?,
                _ => return Err(bad(&format!("{line:?} is not of a header"))),
            }
        }
        let encoding = encoding.ok_or("its header states no format")?;
        Ok((Header { encoding, elements }, rest))
    }
}

/// Adds a property to the last element.
fn add(elements: &mut [Element], name: &str, length: Option<Scalar>, value: &str) -> Result<(), String> {
    let element = elements.last_mut().ok_or("a property needs an element before it")?;
    element.properties.push(Property { name: name.to_owned(), length, value: Scalar::named(value)? });
    Ok(())
}
