/* What a row of a manifest presents to the sensor, and how the appliance answers to it. */
#ifndef SIM_LAB_LANDMARKS_PRESENTATION_H
#define SIM_LAB_LANDMARKS_PRESENTATION_H

#include "sim/lab/landmarks/measure.h"

enum sim_row_kind {
    SIM_ROW_BONA_FIDE,  /* a person: the subject is not `none` */
    SIM_ROW_NOT_A_FACE, /* subject `none` */
    /* Subject `none`, and the note begins with the word of a presentation attack instrument: photo,
     * screen, mask, print, frozen; the whole note is its species (ISO/IEC 30107-3:2023). */
    SIM_ROW_ATTACK,
    SIM_ROW_KINDS
};

enum sim_row_kind sim_row_kind_of(const struct sim_corpus_row *row);

/* Answers in the terms of ISO/IEC 30107-3. */
enum sim_response {
    SIM_RESPONSE_NONE,      /* no template, for a reason that accuses nobody */
    SIM_RESPONSE_BONA_FIDE, /* taken for a living face: a template came of it */
    SIM_RESPONSE_ATTACK,    /* refused as an attack */
    SIM_RESPONSES
};

/* Whether an outcome (sim_capture_reason) says "this is an attack". */
bool sim_reason_is_attack(int reason);

/* The answer to one presentation, from all frames of its row: bona fide if any of them is usable,
 * else an attack if any is refused as one. */
enum sim_response sim_response_to(const struct sim_measured_frame *frames, size_t n);

#endif
