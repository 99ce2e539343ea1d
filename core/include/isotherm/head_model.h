/* The compact statistical head: a mean face with identity and expression modes on a small mesh.
 *
 * shape = mean + sum_i identity[i] a_i + sum_j expression[j] b_j, with a_i, b_j ~ N(0, 1) over the
 * people and expressions it was trained on (linear morphable model: Blanz and Vetter 1999). Face
 * frame: x to the subject's left, y up, z out of the face, millimetres, the mean's nose tip at the
 * origin. Trained by `isotherm-sim train`, stored in one versioned, checksummed file of at most
 * 640 KB. This header parses and writes the bytes of that file; core itself opens no files.
 *
 * File, little endian:
 *   char magic[8] = "ISOHEAD1"; uint32 bytes of the whole file; uint32 crc32 (IEEE 802.3) of all
 *   that follows it; uint32 n_vertices, n_triangles, n_identity, n_expression;
 *   float32 mean[n_vertices][3]; uint16 triangle[n_triangles][3];
 *   uint8 region[n_vertices] (bits of enum iso_head_region);
 *   68 x { uint16 triangle; uint16 reserved 0; float32 weight[3] }: the iBUG landmarks;
 *   (n_identity + n_expression) x { float32 scale; int16 mode[n_vertices][3] }: mm = scale * int.
 */
#ifndef ISOTHERM_HEAD_MODEL_H
#define ISOTHERM_HEAD_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/landmark.h"
#include "isotherm/vec.h"

enum {
    ISO_HEAD_VERTICES_MAX = 4096,
    ISO_HEAD_TRIANGLES_MAX = 8192,
    ISO_HEAD_IDENTITY_MAX = 64,
    ISO_HEAD_EXPRESSION_MAX = 32,
    ISO_HEAD_BYTES_MAX = 640 * 1024,
};

/* What part of the head a vertex belongs to; bits. */
enum iso_head_region {
    ISO_HEAD_FACE = 1,  /* the face proper, in front of the ears, brow to chin */
    ISO_HEAD_RIGID = 2, /* moves least with expression: brow, nose, eye sockets, upper cheeks */
};

/* A point on the model's surface: weights over the corners of one triangle, summing to 1. */
struct iso_head_point {
    uint32_t triangle;
    float weight[3];
};

struct iso_head_model {
    uint32_t n_vertices, n_triangles, n_identity, n_expression;
    uint32_t crc32;           /* identifies the model in templates */
    struct iso_vec3 *mean_mm; /* [n_vertices] */
    uint32_t (*triangles)[3]; /* [n_triangles], counter-clockwise seen from outside */
    uint8_t *region;          /* [n_vertices] */
    float *identity_mm;       /* [n_identity][n_vertices][3] */
    float *expression_mm;     /* [n_expression][n_vertices][3] */
    struct iso_head_point landmarks[ISO_LANDMARKS_IBUG];
};

/* Parses a model file that was read into memory. -EBADMSG with *fault (if not NULL) set to a static
 * text if it is truncated, damaged, of another version or inconsistent; -ENOMEM. */
int iso_head_model_parse(const void *bytes, size_t size, struct iso_head_model **out,
                         const char **fault) __attribute__((warn_unused_result));

/* Writes the file's bytes into a buffer that the caller frees with free(). The model's crc32 field
 * is ignored. -EINVAL if a count is out of range or a value not finite, -EFBIG over
 * ISO_HEAD_BYTES_MAX, -ENOMEM. */
int iso_head_model_serialise(const struct iso_head_model *model, void **bytes, size_t *size)
    __attribute__((warn_unused_result));

/* Allocates a model of the given counts with everything zeroed. -EINVAL out of range, -ENOMEM. */
int iso_head_model_new(uint32_t n_vertices, uint32_t n_triangles, uint32_t n_identity,
                       uint32_t n_expression, struct iso_head_model **out)
    __attribute__((warn_unused_result));
void iso_head_model_free(struct iso_head_model *model);

/* The point on a shape (vertices in the model's order, such as mean_mm). */
struct iso_vec3 iso_head_point_on(const struct iso_head_model *model,
                                  const struct iso_vec3 *vertices_mm, struct iso_head_point point);

#endif
