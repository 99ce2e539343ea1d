/* The triangles of one 2 x 2 cell of a depth grid, whose corners are numbered
 *     0 1
 *     2 3
 * A triangle is named by the corner that it leaves out, so that what a cell holds is a set of four
 * bits: two triangles along one of its diagonals, or what is left of them. */
#ifndef ISO_CORE_SURFACE_CELL_H
#define ISO_CORE_SURFACE_CELL_H

#include <stdbool.h>
#include <stdint.h>

/* Both triangles along the diagonal 0-3, both along 1-2. */
enum { ISO_CELL_FALLING = 1 << 1 | 1 << 2, ISO_CELL_RISING = 1 << 0 | 1 << 3 };

/* Corners of the triangle that leaves out corner k, counter-clockwise seen from the camera, whose
 * image has v downward. Its legs along the grid meet at corner 3 - k. */
static const uint8_t iso_cell_corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 3, 1}, {0, 2, 1}};

/* Names of a set's triangles in the order in which meshes number them. */
struct iso_cell_list {
    uint8_t count;
    uint8_t left_out[2];
};

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

/* The set for a cell given the depths of its corners, 0 where there is none: along the diagonal
 * that is asked for, or the one triangle of three corners; a triangle that spans more than jump_mm
 * of depth is left out. */
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
