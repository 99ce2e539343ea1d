/* Eight floats, four doubles or two doubles at once, by the vector types of gcc and clang. The
 * instructions depend on the processor that the file is compiled for (two SSE or NEON registers, or
 * one AVX register); the results do not. Compilers often leave plain loops scalar. */
#ifndef ISO_CORE_BASE_LANES_H
#define ISO_CORE_BASE_LANES_H

#include <stdint.h>

enum { ISO_LANES = 8 };

typedef float iso_lanes __attribute__((vector_size(ISO_LANES * sizeof(float))));

/* The same bits as whole numbers: for masks. */
typedef int iso_lane_bits __attribute__((vector_size(ISO_LANES * sizeof(int))));

/* Eight floats in memory, aligned like one float. */
typedef float iso_lanes_in_memory
    __attribute__((vector_size(ISO_LANES * sizeof(float)), aligned(4), may_alias));

/* These are macros and not functions, because passing vectors by value depends on the ABI. */
#define ISO_LANES_LOAD(p)         (*(const iso_lanes_in_memory *)(p))
#define ISO_LANES_STORE(p, value) (*(iso_lanes_in_memory *)(p) = (value))

enum { ISO_DOUBLES = 4 };

typedef double iso_doubles __attribute__((vector_size(ISO_DOUBLES * sizeof(double))));
typedef double iso_doubles_in_memory
    __attribute__((vector_size(ISO_DOUBLES * sizeof(double)), aligned(8), may_alias));

#define ISO_DOUBLES_LOAD(p)         (*(const iso_doubles_in_memory *)(p))
#define ISO_DOUBLES_STORE(p, value) (*(iso_doubles_in_memory *)(p) = (value))

/* Two doubles, one register of the plainest x86-64 and arm64: for code that is compiled for every
 * processor, where compilers make single comparisons of wider vectors. */
enum { ISO_PAIR = 2 };

typedef double iso_pair __attribute__((vector_size(ISO_PAIR * sizeof(double))));
typedef double iso_pair_in_memory
    __attribute__((vector_size(ISO_PAIR * sizeof(double)), aligned(8), may_alias));

/* What a comparison of two pairs gives: -1 where it is true, else 0. */
typedef int64_t iso_pair_bits __attribute__((vector_size(ISO_PAIR * sizeof(double))));

#define ISO_PAIR_LOAD(p)         (*(const iso_pair_in_memory *)(p))
#define ISO_PAIR_STORE(p, value) (*(iso_pair_in_memory *)(p) = (value))

#endif
