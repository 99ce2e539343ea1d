#include "enroll/cli/image/update_text.h"

#include <string.h>

#include "enroll/cli/text/report.h"

static const char *or_unknown(const char *text)
{
    return *text ? text : "not known";
}

/* The slot that runs has the running version, whoever installed it. RAUC knows the version of the
 * other one only if it has installed it. */
static void print_slot(const struct cli_slot *slot, FILE *out)
{
    fprintf(out, "%-12s%s", slot->running ? "slot" : "other slot", slot->name);
    if (!slot->running) {
        fprintf(out, ", version %s", or_unknown(slot->version));
    }
    fprintf(out, ", %s%s%s\n", slot->good ? "good" : "bad", slot->running ? ", in use" : "",
            slot->next ? ", starts next" : "");
}

void cli_update_print(const struct cli_update_view *view, FILE *out)
{
    const bool on_trial = view->trial && strcmp(view->trial, "yes") == 0;

    fprintf(out, "%-12s%s (%s)%s\n", "version", or_unknown(view->running.version),
            *view->running.image ? view->running.image : "no image of the appliance",
            on_trial ? ", on trial" : "");
    if (view->busy) {
        fprintf(out, "%-12s%s, %d %%\n", "RAUC", view->state->operation, view->state->percent);
    }
    for (int running = 1; running >= 0; running--) {
        for (size_t i = 0; i < view->slots.n; i++) {
            if (view->slots.slots[i].running == (running == 1)) {
                print_slot(&view->slots.slots[i], out);
            }
        }
    }
}

static json_t *proven_json(const char *trial)
{
    return strcmp(trial, "no") == 0    ? json_true()
           : strcmp(trial, "yes") == 0 ? json_false()
                                       : json_null();
}

json_t *cli_update_json(const struct cli_update_view *view)
{
    json_t *slots = json_array();

    for (size_t i = 0; slots && i < view->slots.n; i++) {
        const struct cli_slot *slot = &view->slots.slots[i];
        const char *version = slot->running ? view->running.version : slot->version;
        (void)json_array_append_new(
            slots, json_pack("{s:s, s:o, s:b, s:b, s:b}", "slot", slot->name, "version",
                             cli_report_text(version), "running", slot->running, "good", slot->good,
                             "next", slot->next));
    }
    json_t *document = json_pack(
        "{s:o, s:s, s:o, s:s, s:i, s:o}", "image", cli_report_text(view->running.image), "board",
        view->state->board, "version", cli_report_text(view->running.version), "operation",
        view->state->operation, "percent", view->state->percent, "slots", slots);
    if (document && view->trial &&
        json_object_set_new(document, "proven", proven_json(view->trial))) {
        json_decref(document);
        document = NULL;
    }
    return document;
}

const struct cli_slot *cli_update_waiting(const struct cli_slots *slots)
{
    for (size_t i = 0; i < slots->n; i++) {
        if (slots->slots[i].next && !slots->slots[i].running) {
            return &slots->slots[i];
        }
    }
    return NULL;
}
