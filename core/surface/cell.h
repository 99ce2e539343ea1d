/* The triangles of one 2 x 2 cell of a depth grid, whose corners are numbered
 *     0 1
 *     2 3
 * A triangle is named by the corner that it leaves out. The triangles of a cell are therefore a set
 * of four bits: the two triangles along one of its diagonals, one triangle, or none. */
#ifndef ISO_CORE_SURFACE_CELL_H
#define ISO_CORE_SURFACE_CELL_H

#include <stdbool.h>
#include <stdint.h>

/* The sets of both triangles along the diagonal 0-3, and along the diagonal 1-2. */
enum { ISO_CELL_FALLING = 1 << 1 | 1 << 2, ISO_CELL_RISING = 1 << 0 | 1 << 3 };

/* Corners of the triangle that leaves out corner k, counter-clockwise seen from the camera. The two
 * legs of the triangle along the grid meet at corner 3 - k. */
static const uint8_t iso_cell_corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 3, 1}, {0, 2, 1}};

/* The triangles of a set in the order in which meshes number them. */
struct iso_cell_list {
    uint8_t count;       /* 0..2 */
    uint8_t left_out[2]; /* [count]: the corner that each triangle leaves out */
};

/* Lists the triangles of a set. */
static inline struct iso_cell_list iso_cell_list(uint8_t set)
{
    static const uint8_t order[4] = {1, 2, 3, 0};
    struct iso_cell_list list = {0};
    for (int k = 0; k < 4; k++) {
        if (set >> order[k] & 1) {
            list.left_out[list.count++ & 1] = order[k];
        }
    }
    return list;
}

/* The set of a cell, given the depths of its corners (0: not measured). With four measured corners
 * it has the two triangles along the diagonal 1-2 if `rising`, else along 0-3; with three corners
 * it has their triangle. A triangle that spans more than jump_mm of depth is left out. */
static inline uint8_t iso_cell_set(const float z[4], bool rising, double jump_mm)
{
    const uint8_t whole = rising ? ISO_CELL_RISING : ISO_CELL_FALLING;
    float low = z[0], high = z[0];
    for (int c = 1; c < 4; c++) {
        low = z[c] < low ? z[c] : low;
        high = z[c] > high ? z[c] : high;
    }
    if (low > 0.0f && (double)(high - low) <= jump_mm) { /* nearly always */
        return whole;
    }
    int missing = (z[0] > 0) + (z[1] > 0) + (z[2] > 0) + (z[3] > 0) == 3
                      ? (z[0] > 0 ? (z[1] > 0 ? (z[2] > 0 ? 3 : 2) : 1) : 0)
                      : -1;
    int set = missing >= 0 ? 1 << missing : whole;
    for (int k = 0; k < 4; k++) {
        const uint8_t *corner = iso_cell_corners[k];
        float a = z[corner[0]], b = z[corner[1]], c = z[corner[2]];
        low = a < b ? a : b;
        low = c < low ? c : low;
        high = a > b ? a : b;
        high = c > high ? c : high;
        if (!(low > 0.0f) || (double)(high - low) > jump_mm) {
            set &= ~(1 << k);
        }
    }
    return (uint8_t)set;
}

#endif
