// owen: nested uniform (Owen) scrambling of base-2 words by hashing.
// Nested uniform scrambling by hashing: on a bit-reversed word every output bit depends only on input bits of
// equal or lower position, which are the more significant digits (Laine & Karras 2011). The low 32 bits of the
// multipliers are Vegdahl's (2021), found by search: the Laine-Karras ones fail 12 N^3 Var = 1. As nothing
// flows downwards, the 32-bit hash of the low half equals the low half of the 64-bit hash: fp32 and fp64 draw
// the same point at two resolutions. Words are kept reversed.
static inline bits owen_hash(bits x, word addend, word factor) {
  x ^= x * (word)0x9C8E6A1F3D20ADEAUL;
  x += addend;
  x *= factor;  // odd
  x ^= x * (word)0x6F3B9D2405526C56UL;
  x ^= x * (word)0xB1D47C5E53A22864UL;
  return x;
}

// Reversal by swapping ever larger groups; compilers know the idiom.
static inline bits reverse_bits(bits x) {
  x = (x >> 1 & (word)0x5555555555555555UL) | (x & (word)0x5555555555555555UL) << 1;
  x = (x >> 2 & (word)0x3333333333333333UL) | (x & (word)0x3333333333333333UL) << 2;
  x = (x >> 4 & (word)0x0F0F0F0F0F0F0F0FUL) | (x & (word)0x0F0F0F0F0F0F0F0FUL) << 4;
  x = (x >> 8 & (word)0x00FF00FF00FF00FFUL) | (x & (word)0x00FF00FF00FF00FFUL) << 8;
#if KOKSMA_FP64
  x = (x >> 16 & 0x0000FFFF0000FFFFUL) | (x & 0x0000FFFF0000FFFFUL) << 16;
  return x >> 32 | x << 32;
#else
  return x >> 16 | x << 16;
#endif
}

