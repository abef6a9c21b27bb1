//! The words of a pbrt file, read as a stream.

use std::io::{self, BufRead, BufReader};

use flate2::bufread::MultiGzDecoder;

/// The first bytes of a gzip file.
pub(super) const GZIP: &[u8] = b"\x1f\x8b";
/// The longest word or quoted string.
const LONGEST: usize = 1 << 16;

/// The kind of a token. Its text is in [`Tokens::text`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// `[`
    Open,
    /// `]`
    Close,
    /// A string in quotes; the text is without them.
    Quoted,
    /// A directive or a number.
    Word,
}

/// Splits a file into tokens. Comments from `#` to the end of the line are skipped. Memory holds a part of the file.
pub(super) struct Tokens<'a> {
    reader: Box<dyn BufRead + 'a>,
    /// Text of the last token.
    text: Vec<u8>,
    /// Byte of the uncompressed file at which the last token begins.
    start: u64,
    offset: u64,
    /// The token to return once more.
    again: Option<Token>,
}

impl<'a> Tokens<'a> {
    /// The tokens of a text, which may be compressed by gzip.
    pub(super) fn new(mut reader: Box<dyn BufRead + 'a>) -> io::Result<Self> {
        if reader.fill_buf()?.starts_with(GZIP) {
            reader = Box::new(BufReader::with_capacity(1 << 18, MultiGzDecoder::new(reader)));
        }
        Ok(Self { reader, text: Vec::new(), start: 0, offset: 0, again: None })
    }

    /// Text of the last token.
    pub(super) fn text(&self) -> &[u8] {
        &self.text
    }

    /// The last token as a number.
    pub(super) fn number(&self) -> Option<f32> {
        std::str::from_utf8(&self.text).ok()?.parse().ok()
    }

    /// The byte at which the last token begins, in the uncompressed file.
    pub(super) fn start(&self) -> u64 {
        self.start
    }

    /// Makes [`Self::next`] return the last token once more.
    pub(super) fn put_back(&mut self, token: Token) {
        self.again = Some(token);
    }

    /// The next token; `None` at the end of the file.
    pub(super) fn next(&mut self) -> io::Result<Option<Token>> {
        if let Some(token) = self.again.take() {
            return Ok(Some(token));
        }
        self.skip(|byte| byte.is_ascii_whitespace())?;
        while self.reader.fill_buf()?.first() == Some(&b'#') {
            self.skip(|byte| byte != b'\n')?;
            self.skip(|byte| byte.is_ascii_whitespace())?;
        }
        self.text.clear();
        self.start = self.offset;
        let Some(&first) = self.reader.fill_buf()?.first() else { return Ok(None) };
        let token = match first {
            b'[' => Token::Open,
            b']' => Token::Close,
            b'"' => Token::Quoted,
            _ => Token::Word,
        };
        if token == Token::Word {
            self.take(|byte| !byte.is_ascii_whitespace() && !matches!(byte, b'[' | b']' | b'"' | b'#'))?;
            return Ok(Some(token));
        }
        self.consume(1);
        if token == Token::Quoted {
            self.take(|byte| byte != b'"')?;
            if self.reader.fill_buf()?.is_empty() {
                return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the file ends inside a string"));
            }
            self.consume(1);
        }
        Ok(Some(token))
    }

    fn consume(&mut self, bytes: usize) {
        self.reader.consume(bytes);
        self.offset += bytes as u64;
    }

    fn skip(&mut self, belongs: impl Fn(u8) -> bool) -> io::Result<()> {
        loop {
            let buffer = self.reader.fill_buf()?;
            let length = buffer.iter().position(|&byte| !belongs(byte)).unwrap_or(buffer.len());
            let ends = length < buffer.len() || buffer.is_empty();
            self.consume(length);
            if ends {
                return Ok(());
            }
        }
    }

    fn take(&mut self, belongs: impl Fn(u8) -> bool) -> io::Result<()> {
        loop {
            let buffer = self.reader.fill_buf()?;
            let length = buffer.iter().position(|&byte| !belongs(byte)).unwrap_or(buffer.len());
            let ends = length < buffer.len() || buffer.is_empty();
            self.text.extend_from_slice(&buffer[..length]);
            self.consume(length);
            if self.text.len() > LONGEST {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "a word of more than 65536 bytes"));
            }
            if ends {
                return Ok(());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Read, Write};

    use super::{Token, Tokens};

    fn tokens(text: &[u8]) -> Vec<(Token, String, u64)> {
        // A buffer of three bytes: every word crosses its end.
        let mut tokens = Tokens::new(Box::new(BufReader::with_capacity(3, text))).expect("readable");
        let mut found = Vec::new();
        while let Some(token) = tokens.next().expect("readable") {
            found.push((token, String::from_utf8_lossy(tokens.text()).into_owned(), tokens.start()));
        }
        found
    }

    #[test]
    fn words_strings_brackets_and_comments() {
        let text = b"# a \"b\"\n Shape\"curve\"[1 -2.5e3]#end\n\"a b\" x#";
        let found = tokens(text);
        let words: Vec<&str> = found.iter().map(|(_, text, _)| text.as_str()).collect();
        assert_eq!(words, ["Shape", "curve", "", "1", "-2.5e3", "", "a b", "x"]);
        assert_eq!((found[0].2, found[1].0, found[2].0), (9, Token::Quoted, Token::Open));
        assert!(tokens(b"").is_empty() && tokens(b" # only").is_empty());
    }

    #[test]
    fn compressed_text_is_unpacked() {
        let mut packed = Vec::new();
        flate2::read::GzEncoder::new(&b"Shape \"curve\""[..], flate2::Compression::fast())
            .read_to_end(&mut packed)
            .expect("packed");
        let found = tokens(&packed);
        assert_eq!((found.len(), found[1].1.as_str()), (2, "curve"));
        packed.truncate(packed.len() / 2);
        packed.flush().expect("memory");
        let mut cut = Tokens::new(Box::new(&packed[..])).expect("readable");
        assert!((0..3).any(|_| cut.next().is_err()));
    }

    #[test]
    fn strings_without_end_are_errors() {
        let endless = [b"\"".to_vec(), vec![b'a'; 1 << 17]].concat();
        for text in [&b"\"abc"[..], &endless] {
            let mut tokens = Tokens::new(Box::new(text)).expect("readable");
            assert!(tokens.next().is_err());
        }
    }
}
