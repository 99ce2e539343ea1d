#include "core/match/upper_face.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/match/upper_surface.h"

enum { COUNTS_PER_MM = 64 };

bool iso_upper_face_known(const struct iso_upper_face *face)
{
    return memchr(face->kind, ISO_UPPER_MEASURED, sizeof face->kind) != NULL;
}

bool iso_upper_face_fits(const struct iso_upper_face *face)
{
    bool fits = true;
    for (int row = 0; row < ISO_UPPER_ROWS; row++) {
        for (int column = 0; column < ISO_UPPER_COLUMNS; column++) {
            const uint8_t kind = face->kind[row][column];
            const float limit_mm = kind == ISO_UPPER_NONE ? 0.0f : 511.0f;
            fits = fits && kind <= ISO_UPPER_MEASURED &&
                   fabsf(face->z_mm[row][column]) <= limit_mm; /* false for NaN */
        }
    }
    return fits;
}

size_t iso_upper_face_put(const struct iso_upper_face *face, uint8_t *bytes)
{
    uint8_t *p = bytes + ISO_UPPER_KIND_BYTES;
    memset(bytes, 0, ISO_UPPER_KIND_BYTES);
    for (int i = 0; i < ISO_UPPER_NODES; i++) {
        const int row = i / ISO_UPPER_COLUMNS, column = i % ISO_UPPER_COLUMNS;
        const uint8_t kind = face->kind[row][column];
        bytes[i / 4] = (uint8_t)(bytes[i / 4] | kind << (i % 4 * 2));
        if (kind != ISO_UPPER_NONE) {
            const long counts = lrintf(face->z_mm[row][column] * COUNTS_PER_MM);
            p = iso_put_u16(p, (uint16_t)(int16_t)counts);
        }
    }
    return (size_t)(p - bytes);
}

int iso_upper_face_get(const uint8_t *bytes, size_t size, struct iso_upper_face *out)
{
    if (size < ISO_UPPER_KIND_BYTES) {
        return -EBADMSG;
    }
    struct iso_upper_face face;
    memset(&face, 0, sizeof face);
    const uint8_t *p = bytes + ISO_UPPER_KIND_BYTES, *end = bytes + size;
    bool whole = true;
    for (int i = 0; whole && i < ISO_UPPER_NODES; i++) {
        const int row = i / ISO_UPPER_COLUMNS, column = i % ISO_UPPER_COLUMNS;
        face.kind[row][column] = bytes[i / 4] >> (i % 4 * 2) & 3;
        if (face.kind[row][column] != ISO_UPPER_NONE) {
            whole = end - p >= 2;
            face.z_mm[row][column] = whole ? (float)(int16_t)iso_get_u16(p) / COUNTS_PER_MM : 0.0f;
            p += whole ? 2 : 0;
        }
    }
    whole = whole && p == end && iso_upper_face_fits(&face);
    if (whole) {
        *out = face;
    }
    explicit_bzero(&face, sizeof face);
    return whole ? 0 : -EBADMSG;
}

/* The height of a moved face at (x, y). *z_mm is a guess of it before the call. The point of the
 * face that the motion `to` takes to (x, y) is found by fixed-point iteration on its height. `back`
 * is the inverse of `to`. Returns false where the face has no surface. */
static bool moved_height(const struct iso_upper_face *face, const struct iso_rigid *to,
                         const struct iso_rigid *back, double x_mm, double y_mm, double *z_mm,
                         bool *measured)
{
    enum { STEPS = 4 };
    double z = *z_mm;
    bool found = false;
    for (int i = 0; i < STEPS; i++) {
        const struct iso_vec3 at = iso_rigid_apply(back, iso_vec3(x_mm, y_mm, z));
        struct iso_upper_place place;
        found = iso_upper_face_at(face, at.x, at.y, &place);
        if (!found) {
            break;
        }
        z = iso_rigid_apply(to, iso_vec3(at.x, at.y, place.z_mm)).z;
        *measured = place.measured > 0.5;
    }
    *z_mm = z;
    return found;
}

/* Sums of the faces' heights at a node: [0] of filled-in ones, [1] of measured ones. */
struct height {
    double sum_mm[2];
    int count[2];
};

static void add_height(struct height *height, double z_mm, bool measured)
{
    height->sum_mm[measured] += z_mm;
    height->count[measured]++;
}

static void add_moved(const struct iso_upper_face *face, const struct iso_rigid *first_from_face,
                      const struct iso_rigid *face_from_first, int row, int column,
                      struct height *height)
{
    double z_mm = (double)face->z_mm[row][column];
    bool measured = false;
    if (moved_height(face, first_from_face, face_from_first, iso_upper_x_mm(column),
                     iso_upper_y_mm(row), &z_mm, &measured)) {
        add_height(height, z_mm, measured);
    }
}

/* Adds the first face. It is not moved: its heights are those of its nodes, also at its edge. */
static void add_first(const struct iso_upper_face *face, int row, int column, struct height *height)
{
    const uint8_t kind = face->kind[row][column];
    if (kind != ISO_UPPER_NONE) {
        add_height(height, (double)face->z_mm[row][column], kind == ISO_UPPER_MEASURED);
    }
}

static void finish(const struct height *height, int row, int column, struct iso_upper_face *out)
{
    const int measured = height->count[1] > 0;
    if (height->count[measured] > 0) {
        out->z_mm[row][column] = (float)(height->sum_mm[measured] / height->count[measured]);
        out->kind[row][column] = measured ? ISO_UPPER_MEASURED : ISO_UPPER_FILLED;
    }
}

/* The faces, whether each of them counts, and their motions to the first one and back. */
struct moved_faces {
    int n;
    const struct iso_upper_face *const *faces;
    const struct iso_rigid *first_from_face;
    bool known[ISO_UPPER_FUSED_MAX];
    struct iso_rigid face_from_first[ISO_UPPER_FUSED_MAX];
};

static void fuse_node(const struct moved_faces *moved, int row, int column,
                      struct iso_upper_face *out)
{
    struct height height = {.count = {0}};
    for (int i = 0; i < moved->n; i++) {
        if (moved->known[i] && i == 0) {
            add_first(moved->faces[i], row, column, &height);
        } else if (moved->known[i]) {
            add_moved(moved->faces[i], &moved->first_from_face[i], &moved->face_from_first[i], row,
                      column, &height);
        }
    }
    finish(&height, row, column, out);
}

void iso_upper_face_fuse(const struct iso_upper_face *const *faces,
                         const struct iso_rigid *first_from_face, int n, struct iso_upper_face *out)
{
    struct moved_faces moved = {.n = n, .faces = faces, .first_from_face = first_from_face};
    for (int i = 0; i < n; i++) {
        moved.known[i] = iso_upper_face_known(faces[i]);
        moved.face_from_first[i] = iso_rigid_inverse(&first_from_face[i]);
    }
    memset(out, 0, sizeof *out);
    for (int row = 0; row < ISO_UPPER_ROWS; row++) {
        for (int column = 0; column < ISO_UPPER_COLUMNS; column++) {
            fuse_node(&moved, row, column, out);
        }
    }
}
