#include "sim/lab/methods/scan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/extract/extract_inside.h"
#include "sim/lab/methods/reflectance.h"

int sim_scan_new(int side, double spacing_mm, struct sim_scan **out)
{
    if (side < 3 || side > 1023 || side % 2 == 0 || !(spacing_mm > 0.0)) {
        return -EINVAL;
    }
    struct sim_scan *face = calloc(1, sizeof *face);
    if (!face) {
        return -ENOMEM;
    }
    face->side = side;
    face->spacing_mm = spacing_mm;
    face->z_mm = calloc(sim_scan_pixels(face), sizeof *face->z_mm);
    face->measured = calloc(sim_scan_pixels(face), 1);
    if (!face->z_mm || !face->measured) {
        sim_scan_free(face);
        return -ENOMEM;
    }
    for (size_t i = 0; i < sim_scan_pixels(face); i++) {
        face->z_mm[i] = NAN;
    }
    *out = face;
    return 0;
}

void sim_scan_free(struct sim_scan *face)
{
    if (!face) {
        return;
    }
    if (face->z_mm) { /* biometric data */
        explicit_bzero(face->z_mm, sim_scan_pixels(face) * sizeof *face->z_mm);
    }
    if (face->reflectance) {
        explicit_bzero(face->reflectance, sim_scan_pixels(face) * sizeof *face->reflectance);
    }
    free(face->reflectance);
    free(face->z_mm);
    free(face->measured);
    explicit_bzero(face, sizeof *face);
    free(face);
}

int sim_scan_of(const struct iso_extractor *extractor, const struct iso_frame *frame,
                const struct iso_extraction *extraction, struct sim_scan **out)
{
    const struct iso_face_patch *patch = iso_extractor_patch(extractor);
    const struct iso_frame *grid = iso_face_patch_frame(patch);
    struct sim_scan *face = NULL;
    int error = sim_scan_new(grid->width_px, grid->camera.pitch_mm, &face);
    if (error) {
        return error;
    }
    for (int row = 0; row < face->side; row++) {
        for (int column = 0; column < face->side; column++) {
            const int i = row * face->side + column;
            if (grid->depth_mm[i] > 0.0f) {
                face->z_mm[i] = (float)ISO_FACE_PATCH_ORIGIN_MM - grid->depth_mm[i];
                struct iso_vec3 p = sim_scan_point(face, column, row);
                face->measured[i] = iso_face_patch_measured(patch, p.x, p.y) > 0.5;
            }
        }
    }
    struct iso_rigid face_from_camera = iso_rigid_inverse(&extraction->camera_from_face);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        face->source_mm[l] = iso_rigid_apply(&face_from_camera, extraction->source_mm[l]);
        face->landmark_mm[l] = iso_rigid_apply(&face_from_camera, extraction->landmark_mm[l]);
    }
    error = sim_reflectance_measure(frame, &extraction->camera_from_face, face);
    if (error) {
        sim_scan_free(face);
        return error;
    }
    *out = face;
    return 0;
}

static void fuse_pixel(const struct sim_scan *const *faces, size_t n, size_t i,
                       struct sim_scan *out)
{
    double sum[2] = {0.0, 0.0}; /* filled in, measured */
    int count[2] = {0, 0};
    for (size_t k = 0; k < n; k++) {
        if (!isnan(faces[k]->z_mm[i])) {
            sum[faces[k]->measured[i]] += (double)faces[k]->z_mm[i];
            count[faces[k]->measured[i]]++;
        }
    }
    const int kind = count[1] > 0;
    out->measured[i] = (uint8_t)kind;
    out->z_mm[i] = count[kind] > 0 ? (float)(sum[kind] / count[kind]) : NAN;
}

static void fuse_points(const struct sim_scan *const *faces, size_t n, struct sim_scan *out)
{
    const double share = 1.0 / (double)n;
    int known[SIM_MARKS] = {0};
    for (size_t k = 0; k < n; k++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            out->source_mm[l] = iso_madd(out->source_mm[l], share, faces[k]->source_mm[l]);
            out->landmark_mm[l] = iso_madd(out->landmark_mm[l], share, faces[k]->landmark_mm[l]);
        }
        for (int m = 0; m < SIM_MARKS; m++) {
            if (faces[k]->mark_known[m]) {
                known[m]++;
                out->mark_mm[m] = iso_add(out->mark_mm[m], faces[k]->mark_mm[m]);
            }
        }
    }
    for (int m = 0; m < SIM_MARKS; m++) {
        out->mark_known[m] = known[m] > 0;
        out->mark_mm[m] = iso_scale(known[m] > 0 ? 1.0 / known[m] : 0.0, out->mark_mm[m]);
    }
}

static int fuse_reflectance(const struct sim_scan *const *faces, size_t n, struct sim_scan *out)
{
    for (size_t k = 0; k < n; k++) {
        if (!faces[k]->reflectance) {
            return 0;
        }
    }
    out->reflectance = calloc(sim_scan_pixels(out), sizeof *out->reflectance);
    for (size_t i = 0; out->reflectance && i < sim_scan_pixels(out); i++) {
        for (size_t k = 0; k < n; k++) {
            out->reflectance[i] += faces[k]->reflectance[i] / (float)n;
        }
    }
    return out->reflectance ? 0 : -ENOMEM;
}

int sim_scan_fuse(const struct sim_scan *const *faces, size_t n, struct sim_scan **out)
{
    if (n == 0) {
        return -EINVAL;
    }
    for (size_t k = 1; k < n; k++) {
        if (faces[k]->side != faces[0]->side || faces[k]->spacing_mm != faces[0]->spacing_mm) {
            return -EINVAL;
        }
    }
    struct sim_scan *fused = NULL;
    int error = sim_scan_new(faces[0]->side, faces[0]->spacing_mm, &fused);
    if (error) {
        return error;
    }
    for (size_t i = 0; i < sim_scan_pixels(fused); i++) {
        fuse_pixel(faces, n, i, fused);
    }
    fuse_points(faces, n, fused);
    error = fuse_reflectance(faces, n, fused);
    if (error) {
        sim_scan_free(fused);
        return error;
    }
    *out = fused;
    return 0;
}

bool sim_scan_height(const struct sim_scan *face, double x_mm, double y_mm, double *z_mm,
                     double *share)
{
    const double column = sim_scan_column(face, x_mm), row = sim_scan_row(face, y_mm);
    const int u = (int)floor(column), v = (int)floor(row), side = face->side;
    if (!(column >= 0.0) || !(row >= 0.0) || u + 1 >= side || v + 1 >= side) {
        return false;
    }
    const double s = column - u, t = row - v;
    const float *z = &face->z_mm[v * side + u];
    const uint8_t *m = &face->measured[v * side + u];
    const double top = (1 - s) * (double)z[0] + s * (double)z[1];
    const double bottom = (1 - s) * (double)z[side] + s * (double)z[side + 1];
    const double height = (1 - t) * top + t * bottom;
    if (isnan(height)) {
        return false;
    }
    if (share) {
        *share = (1 - t) * ((1 - s) * m[0] + s * m[1]) + t * ((1 - s) * m[side] + s * m[side + 1]);
    }
    *z_mm = height;
    return true;
}
