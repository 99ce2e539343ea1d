#include "sim/lab/landmarks/presentation.h"

#include <ctype.h>
#include <string.h>

static bool begins_with_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(text, word, length) == 0 && !isalpha((unsigned char)text[length]);
}

enum sim_row_kind sim_row_kind_of(const struct sim_corpus_row *row)
{
    static const char *const instruments[] = {"photo", "screen", "mask", "print", "frozen"};
    if (strcmp(row->subject, "none") != 0) {
        return SIM_ROW_BONA_FIDE;
    }
    for (size_t i = 0; i < sizeof instruments / sizeof *instruments; i++) {
        if (begins_with_word(row->note, instruments[i])) {
            return SIM_ROW_ATTACK;
        }
    }
    return SIM_ROW_NOT_A_FACE;
}

bool sim_reason_is_attack(int reason)
{
    return reason < ISO_CAPTURES && iso_capture_is_attack((enum iso_capture)reason);
}

enum sim_response sim_response_to(const struct sim_measured_frame *frames, size_t n)
{
    enum sim_response response = SIM_RESPONSE_NONE;
    for (size_t i = 0; i < n; i++) {
        if (frames[i].reason == ISO_CAPTURE_OK) {
            return SIM_RESPONSE_BONA_FIDE;
        }
        if (sim_reason_is_attack(frames[i].reason)) {
            response = SIM_RESPONSE_ATTACK;
        }
    }
    return response;
}
