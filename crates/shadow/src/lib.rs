//! Shadow methods inside hair: their definitions on the processor and their passes on the GPU.
