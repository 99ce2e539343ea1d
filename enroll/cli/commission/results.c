#include "enroll/cli/commission/results.h"

#include <errno.h>
#include <string.h>

#include "drivers/terminal/terminal.h"
#include "firmware/contract/person_name.h"

void cli_results_set(struct cli_result_of_check *result, const char *answer, const char *remark)
{
    result->answer = answer;
    (void)snprintf(result->remark, sizeof result->remark, "%s", remark);
    if (!iso_person_name_has_control(result->remark)) {
        return;
    }
    for (char *at = result->remark; *at; at++) {
        if (*at < ' ' || *at > '~') {
            *at = '?';
        }
    }
}

static enum iso_paint paint_of(const char *answer)
{
    if (strcmp(answer, ISO_CONTRACT_ANSWER_OK) == 0 ||
        strcmp(answer, ISO_CONTRACT_ANSWER_YES) == 0) {
        return ISO_PAINT_GOOD;
    }
    return strcmp(answer, ISO_CONTRACT_ANSWER_FAULT) == 0 ||
                   strcmp(answer, ISO_CONTRACT_ANSWER_NO) == 0
               ? ISO_PAINT_BAD
               : ISO_PAINT_WARNING;
}

void cli_results_print(const struct cli_checklist_item *item,
                       const struct cli_result_of_check *result, FILE *out)
{
    const struct iso_terminal terminal = iso_terminal_of(out);

    fprintf(out, "%s%-8s%s %-12s %s\n", iso_terminal_paint(&terminal, paint_of(result->answer)),
            result->answer, iso_terminal_paint(&terminal, ISO_PAINT_PLAIN), item->item,
            *result->remark ? result->remark : item->text);
}

static int append_items(sd_bus_message *call, const struct cli_check_results *results)
{
    int r = sd_bus_message_open_container(call, 'a', "(sss)");

    for (size_t i = 0; r >= 0 && i < CLI_CHECKLIST_ITEMS; i++) {
        r = sd_bus_message_append(call, "(sss)", cli_checklist[i].item, results->items[i].answer,
                                  results->items[i].remark);
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

enum cli_exit cli_results_record(struct cli_daemon *daemon, const char *by,
                                 const struct cli_check_results *results, char **outcome,
                                 uint64_t *sequence, struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    const char *word = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_RECORD_COMMISSION, &call, fault);

    if (exit) {
        return exit;
    }
    int r = sd_bus_message_append(call, "s", by);
    r = r < 0 ? r : append_items(call, results);
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_RECORD_COMMISSION, fault);
    }
    exit = cli_daemon_send(daemon, call, &reply, fault);
    if (exit) {
        return exit;
    }
    r = sd_bus_message_read(reply, "st", &word, sequence);
    *outcome = r < 0 ? NULL : strdup(word);
    sd_bus_message_unref(reply);
    return *outcome
               ? CLI_EXIT_OK
               : cli_daemon_bad_reply(r < 0 ? r : -ENOMEM, ISO_CONTRACT_RECORD_COMMISSION, fault);
}

json_t *cli_results_json(const struct cli_check_results *results, const char *by,
                         const char *outcome, uint64_t sequence)
{
    json_t *items = json_array();

    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        const struct cli_result_of_check *result = &results->items[i];
        const char *person = cli_checklist[i].way == CLI_WAY_PERSON ? "person" : "machine";
        if (json_array_append_new(items, json_pack("{s:s, s:s, s:s, s:s?}", "item",
                                                   cli_checklist[i].item, "checked_by", person,
                                                   "answer", result->answer, "remark",
                                                   *result->remark ? result->remark : NULL)) < 0) {
            json_decref(items);
            return NULL;
        }
    }
    return json_pack("{s:s, s:s, s:I, s:o}", "outcome", outcome, "by", by, "record",
                     (json_int_t)sequence, "items", items);
}
