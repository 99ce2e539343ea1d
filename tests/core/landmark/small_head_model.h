/* A head model of five vertices, and its file. */
#ifndef TESTS_CORE_LANDMARK_SMALL_HEAD_MODEL_H
#define TESTS_CORE_LANDMARK_SMALL_HEAD_MODEL_H

#include "isotherm/head_model.h"

/* The counts of the small model, and the offsets in its file by the layout of head_model.h. */
enum {
    N_VERTICES = 5,
    N_TRIANGLES = 3,
    N_IDENTITY = 2,
    N_EXPRESSION = 1,
    AT_SIZE = 8,
    AT_CRC = 12,
    AT_COUNTS = 16,
    AT_MEAN = 32,
    AT_TRIANGLES = AT_MEAN + 12 * N_VERTICES,
    AT_REGION = AT_TRIANGLES + 6 * N_TRIANGLES,
    AT_LANDMARKS = AT_REGION + N_VERTICES,
    AT_MODES = AT_LANDMARKS + 68 * 16,
    SIZE = AT_MODES + (N_IDENTITY + N_EXPRESSION) * (4 + 6 * N_VERTICES),
};

/* Returns the model; free it with iso_head_model_free(). Nearly all its numbers differ, so that a
 * test notices two numbers that are swapped. */
struct iso_head_model *small_head_model(void);

/* Returns the file of this model, SIZE bytes. Free it with free(). */
uint8_t *small_head_model_file(void);

/* Writes the checksum of the file again after the file was changed. */
void small_head_model_seal(uint8_t *file, size_t size);

#endif
