/* The blocks of the usual factor, of which some are shrunk at once (core/frame/shrink.h). */
#ifndef ISO_CORE_FRAME_SHRINK_BLOCKS_H
#define ISO_CORE_FRAME_SHRINK_BLOCKS_H

/* The usual factor: a block has ISO_SHRINK_USUAL by ISO_SHRINK_USUAL pixels. */
enum { ISO_SHRINK_USUAL = 4 };

/* Depths further than this from the block's median belong to another surface. */
#define ISO_SHRINK_SAME_MM 20.0f

/* Shrinks blocks that lie side by side, from the first one on. `at` points to the first depth of
 * the first block, in a frame of this width. Writes a depth in mm for each block to `out`
 * [n_blocks], 0 where fewer than a quarter of the pixels were measured, and returns for how many
 * blocks: the largest multiple of 4, or of 8 with AVX2 alone, up to n_blocks. The caller shrinks
 * the others. All functions give the same depths to the bit, and the same as iso_frame_shrink() for
 * a single block.
 */
typedef int iso_shrink_blocks_function(const float *at, int width_px, int n_blocks, float *out);

iso_shrink_blocks_function iso__shrink_blocks_baseline;
iso_shrink_blocks_function iso__shrink_blocks_avx2; /* x86-64 only */
iso_shrink_blocks_function iso_shrink_blocks;       /* the fastest one that this machine can run */

#endif
