/* Puts on record what the checks of a door have shown before it goes into service. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/contract/contract.h"

enum { NOTE_SIZE = ISO_CONTRACT_ITEM_BYTES + ISO_CONTRACT_REMARK_BYTES + 3 };

/* How much an answer speaks against the door: 0 to 2, or -1 if it is none of the words. */
static int weight(const char *answer)
{
    static const struct {
        const char *word;
        int weight;
    } answers[] = {
        {ISO_CONTRACT_ANSWER_OK, 0},      {ISO_CONTRACT_ANSWER_YES, 0},
        {ISO_CONTRACT_ANSWER_WARNING, 1}, {ISO_CONTRACT_ANSWER_SKIPPED, 1},
        {ISO_CONTRACT_ANSWER_FAULT, 2},   {ISO_CONTRACT_ANSWER_NO, 2},
    };
    for (size_t i = 0; i < sizeof answers / sizeof *answers; i++) {
        if (strcmp(answers[i].word, answer) == 0) {
            return answers[i].weight;
        }
    }
    return -1;
}

/* The outcome that follows from all answers. NULL with a fault if there is none. */
static const char *judge(const struct iso_commission *commission, struct iso_fault *fault)
{
    static const char *const outcomes[] = {
        ISO_CONTRACT_COMMISSION_PASSED,
        ISO_CONTRACT_COMMISSION_INCOMPLETE,
        ISO_CONTRACT_COMMISSION_FAILED,
    };
    int worst = 0;
    if (commission->n == 0) {
        (void)iso_fault_set(fault, -EINVAL, "there is no item");
        return NULL;
    }
    for (size_t i = 0; i < commission->n; i++) {
        const struct iso_commission_item *item = &commission->items[i];
        const int own = weight(item->answer);
        if (own < 0) {
            (void)iso_fault_set(fault, -EINVAL, "%s: '%s' is no answer", item->item, item->answer);
            return NULL;
        }
        worst = own > worst ? own : worst;
    }
    return outcomes[worst];
}

/* The items need not wait for the disk one by one, which would hold up the door: they are queued,
 * and get to it together with the outcome, for which the caller waits. */
static int post_item(struct iso_appliance *appliance, const struct iso_commission_item *item,
                     struct iso_fault *fault)
{
    char note[NOTE_SIZE];
    struct iso_audit_record record = iso_audit_record_of("commission");
    (void)snprintf(note, sizeof note, "%s%s%s", item->item, *item->remark ? ": " : "",
                   item->remark);
    record.reason = item->answer;
    record.note = note;
    const int error = iso__appliance_note(appliance, &record);
    return error ? iso_fault_set(fault, error, "%s could not be recorded: %s", item->item,
                                 error == -ENOBUFS ? "too many records wait for the disk"
                                                   : strerror(-error))
                 : 0;
}

int iso_appliance_record_commission(struct iso_appliance *appliance,
                                    const struct iso_commission *commission, const char **outcome,
                                    uint64_t *sequence, struct iso_fault *fault)
{
    char note[512];
    struct iso_fault own = {.text = ""};
    struct iso_audit_record record = iso_audit_record_of("commission");
    record.reason = judge(commission, fault);
    if (!record.reason) {
        return -EINVAL;
    }
    for (size_t i = 0; i < commission->n; i++) {
        const int error = post_item(appliance, &commission->items[i], fault);
        if (error) {
            return error;
        }
    }
    (void)snprintf(note, sizeof note, "%zu items, %s for %s", commission->n, commission->who,
                   commission->by);
    record.note = note;
    const int error = iso_audit_writer_append(appliance->log, &record, ISO_NEVER_NS, sequence,
                                              &own);
    iso__appliance_note_storage(appliance, error, &own);
    if (error) {
        return iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    *outcome = record.reason;
    return 0;
}
