/* Linear finite elements, triangle by triangle: what the stiffness and mass matrices of a mesh
 * (isotherm/stiffness_mass.h) and of an intrinsic triangulation (intrinsic/) have in common. */
#ifndef ISO_CORE_HEAT_ELEMENTS_H
#define ISO_CORE_HEAT_ELEMENTS_H

#include "isotherm/stiffness_mass.h"

/* A triangle. Two of its corners may be the same vertex (of an intrinsic triangulation). */
struct iso_element {
    int32_t corner[3];   /* vertices */
    double cotangent[3]; /* of the angle at each corner */
    double area;
};

/* Gives both matrices the pattern of the diagonal and of all edges, with zeros in it. -ENOSPC if a
 * matrix has too little room: `stiffness` needs n + 3 n_triangles entries while this runs. */
int iso_elements_begin(int32_t n, const int32_t (*triangles)[3], int32_t n_triangles,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
    __attribute__((warn_unused_result));

/* Adds what one triangle contributes. density [n]: linear between the vertices; NULL: 1 everywhere.
 */
void iso_element_add(const struct iso_element *element, enum iso_mass kind, const double *density,
                     struct iso_symmetric *stiffness, struct iso_symmetric *mass);

/* Gives vertices of no triangle a unit mass. */
void iso_elements_end(struct iso_symmetric *mass);

#endif
