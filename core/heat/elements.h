/* Linear finite elements, triangle by triangle: what the stiffness and mass matrices of a mesh
 * (isotherm/stiffness_mass.h) and of an intrinsic triangulation (intrinsic/) have in common. */
#ifndef ISO_CORE_HEAT_ELEMENTS_H
#define ISO_CORE_HEAT_ELEMENTS_H

#include <stdbool.h>

#include "isotherm/stiffness_mass.h"

/* A triangle. Two of its corners may be the same vertex (of an intrinsic triangulation). */
struct iso_element {
    int32_t corner[3];   /* vertices */
    double cotangent[3]; /* of the angle at each corner */
    double area;
};

/* Gives both matrices an entry for each vertex and for each edge, and sets all entries to 0.
 * -ENOSPC if a matrix has too little room. `stiffness` needs room for n + 3 n_triangles entries,
 * because this function first writes an edge once for each of its triangles. */
int iso_elements_begin(int32_t n, const int32_t (*triangles)[3], int32_t n_triangles,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
    __attribute__((warn_unused_result));

/* Gives a matrix the same entries as another one, and sets them to 0. -ENOSPC. */
int iso_elements_copy_pattern(const struct iso_symmetric *from, struct iso_symmetric *to)
    __attribute__((warn_unused_result));

/* Whether all densities [n] are finite and above 0; NULL is 1 everywhere. */
bool iso_elements_density_is_good(const double *density, int32_t n);

/* Adds what one triangle contributes. density [n]: linear between the vertices; NULL: 1 everywhere.
 */
void iso_element_add(const struct iso_element *element, enum iso_mass kind, const double *density,
                     struct iso_symmetric *stiffness, struct iso_symmetric *mass);

/* Gives vertices of no triangle a unit mass. */
void iso_elements_end(struct iso_symmetric *mass);

#endif
