#include "sim/world/face/obj_points.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"

enum { BYTES_MAX = 64 << 20, CORNERS_MAX = 16 };

struct reader {
    const char *path;
    size_t line;
    uint32_t points_room, triangles_room;
    struct sim_obj obj;
    struct iso_fault *fault;
};

static int flaw(const struct reader *reader, const char *what)
{
    return iso_fault_set(reader->fault, -EBADMSG, "%s:%zu: %s", reader->path, reader->line, what);
}

/* Makes room for one more item of a growing array. */
static bool make_room(void **items, uint32_t n, uint32_t *room, size_t size)
{
    if (n < *room) {
        return true;
    }
    const uint32_t more = *room ? *room * 2 : 4096;
    void *moved = realloc(*items, more * size);
    if (moved) {
        *items = moved;
        *room = more;
    }
    return moved != NULL;
}

static int add_point(struct reader *reader, const char *text)
{
    double point[3];
    for (int i = 0; i < 3; i++) {
        char *end;
        point[i] = strtod(text, &end);
        if (end == text || !isfinite(point[i])) {
            return flaw(reader, "not a vertex: three numbers belong here");
        }
        text = end;
    }
    struct sim_obj *obj = &reader->obj;
    void *points = obj->points;
    if (!make_room(&points, obj->n_points, &reader->points_room, sizeof *obj->points)) {
        return iso_fault_set(reader->fault, -ENOMEM, "%s: out of memory", reader->path);
    }
    obj->points = points;
    memcpy(obj->points[obj->n_points++], point, sizeof point);
    return 0;
}

static int add_triangle(struct reader *reader, uint32_t a, uint32_t b, uint32_t c)
{
    struct sim_obj *obj = &reader->obj;
    void *triangles = obj->triangles;
    if (!make_room(&triangles, obj->n_triangles, &reader->triangles_room, sizeof *obj->triangles)) {
        return iso_fault_set(reader->fault, -ENOMEM, "%s: out of memory", reader->path);
    }
    obj->triangles = triangles;
    const uint32_t corners[3] = {a, b, c};
    memcpy(obj->triangles[obj->n_triangles++], corners, sizeof corners);
    return 0;
}

/* Corners "12", "12/3" or "12/3/4", counted from 1. The texture and normal indices are ignored. */
static int add_face(struct reader *reader, const char *text)
{
    uint32_t corner[CORNERS_MAX];
    int n = 0;
    for (;;) {
        char *end;
        const unsigned long number = strtoul(text, &end, 10);
        if (end == text) {
            break;
        }
        if (n == CORNERS_MAX || number < 1 || number > reader->obj.n_points) {
            return flaw(reader, "not a face: a corner is none of the vertices before it");
        }
        corner[n++] = (uint32_t)(number - 1);
        text = end + strcspn(end, " \t");
    }
    if (n < 3) {
        return flaw(reader, "not a face: three corners belong here");
    }
    int error = 0;
    for (int i = 1; i + 1 < n && !error; i++) {
        error = add_triangle(reader, corner[0], corner[i], corner[i + 1]);
    }
    return error;
}

static int read_line(struct reader *reader, const char *line)
{
    if (strncmp(line, "v ", 2) == 0) {
        return add_point(reader, line + 2);
    }
    return strncmp(line, "f ", 2) == 0 ? add_face(reader, line + 2) : 0;
}

int sim_obj_read(const char *path, struct sim_obj *out, struct iso_fault *fault)
{
    struct reader reader = {.path = path, .fault = fault};
    char *bytes = NULL;
    size_t size = 0;
    int error = iso_file_read(path, BYTES_MAX, &bytes, &size, fault);
    for (char *line = bytes, *next; !error && line; line = next) {
        next = strchr(line, '\n');
        if (next) {
            *next++ = '\0';
        }
        reader.line++;
        error = read_line(&reader, line);
    }
    free(bytes);
    if (error) {
        sim_obj_done(&reader.obj);
        return error;
    }
    *out = reader.obj;
    return 0;
}

void sim_obj_done(struct sim_obj *obj)
{
    free(obj->points);
    free(obj->triangles);
    *obj = (struct sim_obj){.n_points = 0};
}
