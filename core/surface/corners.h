/* The corners of a triangle in the order of their numbers: finds triangles that have the same
 * corners, whatever order they have in the mesh. */
#ifndef ISO_CORE_SURFACE_CORNERS_H
#define ISO_CORE_SURFACE_CORNERS_H

#include <stdbool.h>
#include <stdint.h>

struct iso_corners {
    int32_t sorted[3]; /* rising */
    int32_t triangle;  /* its position in the list of triangles */
};

struct iso_corners iso_corners_of(const int32_t corner[3], int32_t triangle);

/* For qsort(): by the corners, and triangles with the same corners by their position. */
int iso_corners_compare(const void *a, const void *b);

bool iso_corners_are_same(const struct iso_corners *a, const struct iso_corners *b);

#endif
