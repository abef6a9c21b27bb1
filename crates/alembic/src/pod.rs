//! Types of numbers.

/// The type of the numbers of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Pod {
    /// One byte, 0 or 1.
    Bool,
    /// 8 bits, unsigned.
    U8,
    /// 8 bits, signed.
    I8,
    /// 16 bits, unsigned.
    U16,
    /// 16 bits, signed.
    I16,
    /// 32 bits, unsigned.
    U32,
    /// 32 bits, signed.
    I32,
    /// 64 bits, unsigned.
    U64,
    /// 64 bits, signed.
    I64,
    /// Half precision.
    F16,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
    /// Text in UTF-8, each ended by a zero.
    String,
    /// Text of 32-bit characters, each ended by a zero.
    WideString,
}

impl Pod {
    const ALL: [Self; 14] = [
        Self::Bool,
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F16,
        Self::F32,
        Self::F64,
        Self::String,
        Self::WideString,
    ];

    /// The type with this code in a file.
    pub(crate) fn of_code(code: u32) -> Option<Self> {
        Self::ALL.get(code as usize).copied()
    }

    /// The name in metadata of parameters of geometry.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool_t",
            Self::U8 => "uint8_t",
            Self::I8 => "int8_t",
            Self::U16 => "uint16_t",
            Self::I16 => "int16_t",
            Self::U32 => "uint32_t",
            Self::I32 => "int32_t",
            Self::U64 => "uint64_t",
            Self::I64 => "int64_t",
            Self::F16 => "float16_t",
            Self::F32 => "float32_t",
            Self::F64 => "float64_t",
            Self::String => "string",
            Self::WideString => "wstring",
        }
    }

    /// Bytes of one number; 0 for text.
    pub fn bytes(self) -> usize {
        match self {
            Self::Bool | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
            Self::String | Self::WideString => 0,
        }
    }

    /// The number in these bytes, of which there are [`Self::bytes`]; `None` for text.
    pub(crate) fn number(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::Bool | Self::U8 => f64::from(*bytes.first()?),
            Self::I8 => f64::from(i8::from_le_bytes([*bytes.first()?])),
            Self::U16 => f64::from(u16::from_le_bytes(bytes.try_into().ok()?)),
            Self::I16 => f64::from(i16::from_le_bytes(bytes.try_into().ok()?)),
            Self::U32 => f64::from(u32::from_le_bytes(bytes.try_into().ok()?)),
            Self::I32 => f64::from(i32::from_le_bytes(bytes.try_into().ok()?)),
            Self::U64 => u64::from_le_bytes(bytes.try_into().ok()?) as f64,
            Self::I64 => i64::from_le_bytes(bytes.try_into().ok()?) as f64,
            Self::F16 => half::f16::from_le_bytes(bytes.try_into().ok()?).to_f64(),
            Self::F32 => f64::from(f32::from_le_bytes(bytes.try_into().ok()?)),
            Self::F64 => f64::from_le_bytes(bytes.try_into().ok()?),
            Self::String | Self::WideString => return None,
        })
    }
}

/// The type of an element: several numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DataType {
    /// Type of its numbers.
    pub pod: Pod,
    /// Count of its numbers, 1 to 255.
    pub extent: u8,
}

impl DataType {
    /// An element of `extent` numbers.
    pub const fn new(pod: Pod, extent: u8) -> Self {
        Self { pod, extent }
    }
}
