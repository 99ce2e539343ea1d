/** @file
 * The statistical head: a mean face with modes of identity and expression on a small mesh.
 *
 *     shape = mean + sum_i identity[i] a_i + sum_j expression[j] b_j
 *
 * The coefficients have the distribution N(0, 1) over the people and expressions that the model was
 * trained on (linear morphable model: Blanz and Vetter 1999). Face frame: x to the subject's left,
 * y up, z out of the face, millimetres; the tip of the mean nose is the origin.
 *
 * The file, little endian:
 *
 *     char magic[8] = "ISOHEAD1"; uint32 bytes of the whole file;
 *     uint32 crc32 (IEEE 802.3) of all that follows it;
 *     uint32 n_vertices, n_triangles, n_identity, n_expression;
 *     float32 mean[n_vertices][3]; uint16 triangle[n_triangles][3];
 *     uint8 region[n_vertices] (bits of enum iso_head_region);
 *     68 x { uint16 triangle; uint16 reserved 0; float32 weight[3] }: the iBUG landmarks;
 *     (n_identity + n_expression) x { float32 scale; int16 mode[n_vertices][3] }:
 *     millimetres = scale * integer
 *
 * The functions read and write the bytes of that file; the library opens no files. */
#ifndef ISOTHERM_HEAD_MODEL_H
#define ISOTHERM_HEAD_MODEL_H

#include <stddef.h>
#include <stdint.h>

#include "isotherm/fault.h"
#include "isotherm/landmark.h"
#include "isotherm/vec.h"

enum {
    ISO_HEAD_VERTICES_MAX = 4096,    /**< Most vertices of a model. */
    ISO_HEAD_TRIANGLES_MAX = 8192,   /**< Most triangles of a model. */
    ISO_HEAD_IDENTITY_MAX = 64,      /**< Most modes of identity. */
    ISO_HEAD_EXPRESSION_MAX = 32,    /**< Most modes of expression. */
    ISO_HEAD_BYTES_MAX = 640 * 1024, /**< Largest file of a model, bytes. */
};

/** What part of the head a vertex belongs to; bits. */
enum iso_head_region {
    ISO_HEAD_FACE = 1, /**< The face proper, in front of the ears, from the forehead to the chin. */
    ISO_HEAD_RIGID = 2, /**< Moves least with expression: brow, nose, eye sockets, upper cheeks. */
};

/** A point on the model's surface. */
struct iso_head_point {
    uint32_t triangle; /**< Index of the triangle. */
    float weight[3];   /**< Weights of the triangle's corners; their sum is 1. */
};

/** A head model. It owns its arrays. */
struct iso_head_model {
    uint32_t n_vertices;      /**< Vertices. */
    uint32_t n_triangles;     /**< Triangles. */
    uint32_t n_identity;      /**< Modes of identity. */
    uint32_t n_expression;    /**< Modes of expression. */
    uint32_t crc32;           /**< Identifies the model in templates. */
    struct iso_vec3 *mean_mm; /**< [n_vertices]: the mean face, millimetres. */
    uint32_t (*triangles)[3]; /**< [n_triangles]: counter-clockwise seen from outside. */
    uint8_t *region;          /**< [n_vertices]: bits of enum iso_head_region. */
    float *identity_mm;       /**< [n_identity][n_vertices][3]: modes of identity, millimetres. */
    float *expression_mm;     /**< [n_expression][n_vertices][3]: modes of expression. */
    struct iso_head_point landmarks[ISO_LANDMARKS_IBUG]; /**< The 68 landmarks of iBUG 300-W. */
};

/** Reads the bytes of a model file.
 *
 * @param bytes  The file; it may be freed afterwards.
 * @param size   Its size, bytes.
 * @param out    Receives the model; free it with iso_head_model_free().
 * @param fault  If not NULL: on failure, receives a text that says what is wrong.
 * @return 0; -EBADMSG if the file is truncated, damaged, of another version or inconsistent;
 *         -ENOMEM. */
int iso_head_model_parse(const void *bytes, size_t size, struct iso_head_model **out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/** Writes the bytes of a model file.
 *
 * @param model  The model; its member crc32 is ignored.
 * @param bytes  Receives a buffer that the caller frees with free().
 * @param size   Receives the size of the buffer, bytes.
 * @return 0; -EINVAL for a model that iso_head_model_parse() would refuse (a count out of range, a
 *         value that is not finite, a bad triangle, landmark or region); -EFBIG if the file would
 *         exceed ISO_HEAD_BYTES_MAX; -ENOMEM. */
int iso_head_model_serialise(const struct iso_head_model *model, void **bytes, size_t *size)
    __attribute__((warn_unused_result));

/** Makes a model of zeros, to be filled in.
 *
 * @param n_vertices    Vertices, up to ISO_HEAD_VERTICES_MAX.
 * @param n_triangles   Triangles, up to ISO_HEAD_TRIANGLES_MAX.
 * @param n_identity    Modes of identity, up to ISO_HEAD_IDENTITY_MAX.
 * @param n_expression  Modes of expression, up to ISO_HEAD_EXPRESSION_MAX.
 * @param out           Receives the model; free it with iso_head_model_free().
 * @return 0; -EINVAL for a count out of range; -ENOMEM. */
int iso_head_model_new(uint32_t n_vertices, uint32_t n_triangles, uint32_t n_identity,
                       uint32_t n_expression, struct iso_head_model **out)
    __attribute__((warn_unused_result));

/** Frees a model.
 *
 * @param model  The model, or NULL. */
void iso_head_model_free(struct iso_head_model *model);

/** A point of the model on one of its shapes.
 *
 * @param model        The model.
 * @param vertices_mm  [n_vertices]: the vertices of a shape in the model's order, such as mean_mm.
 * @param point        The point on the model's surface.
 * @return Where the point lies on that shape, millimetres. */
struct iso_vec3 iso_head_point_on(const struct iso_head_model *model,
                                  const struct iso_vec3 *vertices_mm, struct iso_head_point point);

#endif
