#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "sim/corpus/scan_file.h"

static const double coordinate_max_mm = 1e5;

/* A list of elements of one size that grows by doubling. */
struct list {
    void *items;
    size_t n, capacity, item_bytes;
};

struct parser {
    const char *name, *at;
    struct iso_fault *fault;
    struct list points, triangles; /* struct iso_vec3; int32_t[3] */
    size_t first_point;            /* of the last node read; its faces count from here */
};

static void *list_add(struct list *list)
{
    if (list->n == list->capacity) {
        const size_t capacity = 2 * list->capacity + 256;
        void *items = realloc(list->items, capacity * list->item_bytes);
        if (!items) {
            return NULL;
        }
        list->items = items;
        list->capacity = capacity;
    }
    return (char *)list->items + list->item_bytes * list->n++;
}

static int refuse_file(const struct parser *p, const char *what)
{
    return iso_fault_set(p->fault, -EBADMSG, "%s: %s", p->name, what);
}

static int out_of_memory(const struct parser *p)
{
    return iso_fault_set(p->fault, -ENOMEM, "%s: out of memory", p->name);
}

/* Skips blanks, commas and comments. */
static void skip_blanks(struct parser *p)
{
    for (;;) {
        p->at += strspn(p->at, " \t\r\n,");
        if (*p->at != '#') {
            return;
        }
        p->at += strcspn(p->at, "\r\n");
    }
}

/* The next word, brace, bracket or quoted text; false at the end. */
static bool next_token(struct parser *p, const char **begin, size_t *length)
{
    skip_blanks(p);
    *begin = p->at;
    if (*p->at == '\0') {
        return false;
    }
    if (*p->at == '"') {
        const size_t n = 1 + strcspn(p->at + 1, "\"");
        p->at += p->at[n] == '"' ? n + 1 : n;
    } else if (strchr("{}[]", *p->at)) {
        p->at++;
    } else {
        p->at += strcspn(p->at, " \t\r\n,#\"{}[]");
    }
    *length = (size_t)(p->at - *begin);
    return true;
}

static bool is_word(const char *begin, size_t length, const char *word)
{
    return strlen(word) == length && strncmp(begin, word, length) == 0;
}

/* Reads the next number of a list. False at its "]", or with *error set. */
static bool next_number(struct parser *p, double *value, int *error)
{
    skip_blanks(p);
    if (*p->at == ']') {
        p->at++;
        return false;
    }
    char *end;
    *value = strtod(p->at, &end);
    if (end == p->at || !isfinite(*value)) {
        *error = refuse_file(p, "a list ends, or has no number, before its ]");
        return false;
    }
    p->at = end;
    return true;
}

static int open_list(struct parser *p)
{
    skip_blanks(p);
    if (*p->at != '[') {
        return refuse_file(p, "a list does not begin with [");
    }
    p->at++;
    return 0;
}

static int read_points(struct parser *p)
{
    int error = open_list(p);
    double value, xyz[3];
    int k = 0;
    p->first_point = p->points.n;
    while (!error && next_number(p, &value, &error)) {
        if (fabs(value) > coordinate_max_mm) {
            return refuse_file(p, "a coordinate is out of range");
        }
        xyz[k++] = value;
        if (k == 3) {
            struct iso_vec3 *point = p->points.n < SIM_SCAN_POINTS_MAX ? list_add(&p->points)
                                                                       : NULL;
            if (!point) {
                return out_of_memory(p);
            }
            *point = iso_vec3(xyz[0], xyz[1], xyz[2]);
            k = 0;
        }
    }
    return error || k == 0 ? error : refuse_file(p, "a point does not have three coordinates");
}

static int add_triangle(struct parser *p, const int32_t corner[3])
{
    int32_t(*triangle)[3] = p->triangles.n < 2 * (size_t)SIM_SCAN_POINTS_MAX
                                ? list_add(&p->triangles)
                                : NULL;
    if (!triangle) {
        return out_of_memory(p);
    }
    memcpy(*triangle, corner, sizeof *triangle);
    return 0;
}

/* Polygons end with -1; the last one may end with the list. */
static int read_faces(struct parser *p)
{
    int error = open_list(p);
    double value;
    int32_t corner[3] = {0};
    int n = 0; /* corners of the polygon so far */
    while (!error && next_number(p, &value, &error)) {
        if (value == -1.0) {
            n = 0;
            continue;
        }
        const double index = (double)p->first_point + value;
        if (value != floor(value) || value < 0.0 || index >= (double)p->points.n) {
            return refuse_file(p, "a face has a corner that is not among the points");
        }
        corner[n < 2 ? n : 2] = (int32_t)index;
        n++;
        if (n >= 3 && corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0]) {
            error = add_triangle(p, corner);
        }
        if (n >= 3) {
            corner[1] = corner[2];
        }
    }
    return error;
}

/* Walks through the file. The field name and the node of a list determine its meaning. */
static int parse_nodes(struct parser *p)
{
    const char *word, *last = "", *node = "";
    size_t length, last_length = 0, node_length = 0;
    int error = 0;
    while (!error && next_token(p, &word, &length)) {
        const bool coordinate = is_word(node, node_length, "Coordinate") ||
                                is_word(node, node_length, "Coordinate3");
        if (is_word(word, length, "{")) {
            node = last;
            node_length = last_length;
        } else if (coordinate && is_word(word, length, "point")) {
            error = read_points(p);
        } else if (is_word(word, length, "coordIndex")) {
            error = read_faces(p);
        }
        last = word;
        last_length = length;
    }
    return error;
}

static int make_mesh(struct parser *p, struct iso_mesh **out)
{
    struct iso_mesh *mesh = NULL;
    if (p->triangles.n == 0) {
        return refuse_file(p, "no faces in it");
    }
    if (iso_mesh_new((int32_t)p->points.n, (int32_t)p->triangles.n, &mesh)) {
        return out_of_memory(p);
    }
    mesh->n_vertices = (int32_t)p->points.n;
    mesh->n_triangles = (int32_t)p->triangles.n;
    memcpy(mesh->vertices_mm, p->points.items, p->points.n * p->points.item_bytes);
    memcpy(mesh->triangles, p->triangles.items, p->triangles.n * p->triangles.item_bytes);
    *out = mesh;
    return 0;
}

int sim_scan_parse_vrml(const char *name, const char *bytes, size_t size, struct iso_mesh **out,
                        struct iso_fault *fault)
{
    struct parser p = {
        .name = name,
        .at = bytes,
        .fault = fault,
        .points = {.item_bytes = sizeof(struct iso_vec3)},
        .triangles = {.item_bytes = sizeof(int32_t[3])},
    };
    (void)size; /* ends with a NUL */
    int error = strncmp(bytes, "#VRML V", 7) == 0 ? parse_nodes(&p) : refuse_file(&p, "not VRML");
    if (!error) {
        error = make_mesh(&p, out);
    }
    free(p.points.items);
    free(p.triangles.items);
    return error;
}
