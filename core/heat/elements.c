#include "core/heat/elements.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* The rows of one column, the diagonal first: sorts them and removes repetitions. Returns how many
 * there are. */
static int32_t sort_unique(int32_t *row, int32_t n)
{
    for (int32_t i = 2; i < n; i++) {
        int32_t value = row[i], at = i;
        for (; at > 1 && row[at - 1] > value; at--) {
            row[at] = row[at - 1];
        }
        row[at] = value;
    }
    int32_t kept = 1;
    for (int32_t i = 1; i < n; i++) {
        if (row[i] != row[kept - 1]) {
            row[kept++] = row[i];
        }
    }
    return kept;
}

/* The pattern: the diagonal and one entry for each edge. Each edge is first written once for each
 * of its triangles, in place; then repetitions are removed. */
static int make_pattern(int32_t n, const int32_t (*triangles)[3], int32_t n_triangles,
                        struct iso_symmetric *a)
{
    if (n > a->n_capacity || n + 3 * n_triangles > a->nnz_capacity) {
        return -ENOSPC;
    }
    int32_t *start = a->column_start;
    start[0] = 0;
    for (int32_t j = 0; j < n; j++) {
        start[j + 1] = 1;
    }
    for (int32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t p = triangles[t][k], q = triangles[t][(k + 1) % 3];
            start[(p < q ? p : q) + 1]++;
        }
    }
    for (int32_t j = 0; j < n; j++) {
        start[j + 1] += start[j];
    }
    /* Each entry that is written moves the start of its column forward. At the end each start is at
     * the end of its column. */
    for (int32_t j = 0; j < n; j++) {
        a->row[start[j]++] = j;
    }
    for (int32_t t = 0; t < n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            int32_t p = triangles[t][k], q = triangles[t][(k + 1) % 3];
            a->row[start[p < q ? p : q]++] = p < q ? q : p;
        }
    }
    int32_t nnz = 0, from = 0;
    for (int32_t j = 0; j < n; j++) {
        int32_t to = start[j], count = sort_unique(&a->row[from], to - from);
        memmove(&a->row[nnz], &a->row[from], (size_t)count * sizeof *a->row);
        start[j] = nnz;
        nnz += count;
        from = to;
    }
    start[n] = nnz;
    a->n = n;
    a->nnz = nnz;
    memset(a->value, 0, (size_t)nnz * sizeof *a->value);
    return 0;
}

static void add_entry(struct iso_symmetric *a, int32_t i, int32_t j, double value)
{
    int32_t column = i < j ? i : j, row = i < j ? j : i, at = a->column_start[column];
    while (a->row[at] != row) {
        at++;
    }
    a->value[at] += value;
}

int iso_elements_copy_pattern(const struct iso_symmetric *from, struct iso_symmetric *to)
{
    if (from->n > to->n_capacity || from->nnz > to->nnz_capacity) {
        return -ENOSPC;
    }
    to->n = from->n;
    to->nnz = from->nnz;
    memcpy(to->column_start, from->column_start, ((size_t)to->n + 1) * sizeof *to->column_start);
    memcpy(to->row, from->row, (size_t)to->nnz * sizeof *to->row);
    memset(to->value, 0, (size_t)to->nnz * sizeof *to->value);
    return 0;
}

bool iso_elements_density_is_good(const double *density, int32_t n)
{
    for (int32_t i = 0; density && i < n; i++) {
        if (!(density[i] > 0.0) || !isfinite(density[i])) {
            return false;
        }
    }
    return true;
}

int iso_elements_begin(int32_t n, const int32_t (*triangles)[3], int32_t n_triangles,
                       struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    const int error = make_pattern(n, triangles, n_triangles, stiffness);
    return error ? error : iso_elements_copy_pattern(stiffness, mass);
}

void iso_elements_end(struct iso_symmetric *mass)
{
    for (int32_t i = 0; i < mass->n; i++) {
        double *diagonal = &mass->value[mass->column_start[i]];
        *diagonal = *diagonal > 0.0 ? *diagonal : 1.0;
    }
}

/* Densities at the corners of a triangle, and their mean. */
struct corner_density {
    double at[3], mean;
};

static struct corner_density density_of(const double *density, const int32_t *corner)
{
    struct corner_density h = {{1.0, 1.0, 1.0}, 1.0};
    if (density) {
        for (int k = 0; k < 3; k++) {
            h.at[k] = density[corner[k]];
        }
        h.mean = (h.at[0] + h.at[1] + h.at[2]) / 3.0;
    }
    return h;
}

void iso_element_add(const struct iso_element *element, enum iso_mass kind, const double *density,
                     struct iso_symmetric *stiffness, struct iso_symmetric *mass)
{
    const int32_t *v = element->corner;
    const struct corner_density h = density_of(density, v);
    const double area = element->area;
    for (int k = 0; k < 3; k++) {
        const int32_t p = v[(k + 1) % 3], q = v[(k + 2) % 3];
        const double conducted = 0.5 * h.mean * element->cotangent[k];
        if (p != q) { /* no heat flows along an edge from a vertex to itself */
            add_entry(stiffness, p, q, -conducted);
            add_entry(stiffness, p, p, conducted);
            add_entry(stiffness, q, q, conducted);
        }
        if (kind == ISO_MASS_CONSISTENT) {
            const double opposite = h.at[(k + 1) % 3] + h.at[(k + 2) % 3];
            const double both = p == q ? 2.0 : 1.0; /* (p, q) and (q, p) are one entry then */
            add_entry(mass, p, q, both * (area * (opposite / 60.0 + h.mean / 20.0)));
            add_entry(mass, v[k], v[k], area * (h.at[k] / 15.0 + h.mean / 10.0));
        } else { /* lumped: the sum of a row of the consistent matrix */
            add_entry(mass, v[k], v[k], area * (h.at[k] / 12.0 + h.mean / 4.0));
        }
    }
}
