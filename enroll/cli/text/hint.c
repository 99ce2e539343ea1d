#include "enroll/cli/text/hint.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "isotherm/capture.h"

bool cli_hint_is_retry(const char *result, const char *prefix, const char **capture_word)
{
    static const char infix[] = "-" ISO_CONTRACT_RESULT_RETRY;
    const size_t length = strlen(prefix);

    if (strncmp(result, prefix, length) != 0 ||
        strncmp(result + length, infix, sizeof infix - 1) != 0) {
        return false;
    }
    *capture_word = result + length + sizeof infix - 1;
    return true;
}

/* Whether the word asks to turn, bow or lift the head. */
static bool is_turn(const char *capture_word)
{
    static const enum iso_capture turns[] = {ISO_CAPTURE_TURN_LEFT, ISO_CAPTURE_TURN_RIGHT,
                                             ISO_CAPTURE_LOOK_UP, ISO_CAPTURE_LOOK_DOWN};

    for (size_t i = 0; i < sizeof turns / sizeof *turns; i++) {
        if (strcmp(capture_word, iso_capture_name(turns[i])) == 0) {
            return true;
        }
    }
    return false;
}

void cli_hints_say(struct cli_hints *hints, const char *capture_word)
{
    const char *text = cli_hint_text(capture_word);
    const double turn_deg = is_turn(capture_word) ? hints->turn_deg : 0;
    const bool same = strcmp(hints->last, capture_word) == 0;

    if (same && fabs(turn_deg - hints->last_deg) <= 5) {
        return;
    }
    hints->last_deg = turn_deg;
    (void)snprintf(hints->last, sizeof hints->last, "%s", capture_word);
    fprintf(hints->out, "  %s", text ? text : capture_word);
    if (turn_deg > 0) {
        fprintf(hints->out, ", by about %.0f degrees", turn_deg);
    }
    fputc('\n', hints->out);
    if (!same) {
        hints->said = hints->said ? hints->said : json_array();
        (void)json_array_append_new(hints->said, json_string(capture_word));
    }
}

json_t *cli_hints_take(struct cli_hints *hints)
{
    json_t *said = hints->said ? hints->said : json_array();

    hints->said = NULL;
    return said;
}
