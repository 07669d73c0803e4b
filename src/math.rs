//! Own numeric kernels that give the same bits on every CPU.
