/* What a row of a manifest presents to the sensor, and the appliance's answer to it. */
#ifndef SIM_LAB_LANDMARKS_PRESENTATION_H
#define SIM_LAB_LANDMARKS_PRESENTATION_H

#include "sim/lab/landmarks/measure.h"

enum sim_row_kind {
    SIM_ROW_BONA_FIDE,  /* a person: the subject is not `none` */
    SIM_ROW_NOT_A_FACE, /* subject `none` */
    /* Subject `none`, and the note begins with the name of a presentation attack instrument:
     * photo, screen, mask, print or frozen. The whole note is the instrument's species (ISO/IEC
     * 30107-3:2023). */
    SIM_ROW_ATTACK,
    SIM_ROW_KINDS
};

/* The kind of a row, from its subject and its note. */
enum sim_row_kind sim_row_kind_of(const struct sim_corpus_row *row);

/* Answers in the terms of ISO/IEC 30107-3. */
enum sim_response {
    SIM_RESPONSE_NONE,      /* no template, and no suspicion of an attack */
    SIM_RESPONSE_BONA_FIDE, /* accepted as a living face: there is a template */
    SIM_RESPONSE_ATTACK,    /* refused as an attack */
    SIM_RESPONSES
};

/* Whether an outcome (sim_capture_reason) reports an attack. */
bool sim_reason_is_attack(int reason);

/* The answer to one presentation, from all frames of its row: bona fide if any frame is usable,
 * otherwise attack if any frame is refused as an attack. */
enum sim_response sim_response_to(const struct sim_measured_frame *frames, size_t n);

#endif
