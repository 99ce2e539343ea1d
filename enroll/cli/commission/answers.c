#include "enroll/cli/commission/answers.h"

#include <errno.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/ini_table.h"
#include "drivers/file/text.h"

enum { FILE_MAX = 64 * 1024, KEYS = CLI_CHECKLIST_ITEMS + 1 };

/* ---- from a file ---- */

static int parse_name(const char *value, void *field)
{
    if (iso_person_name_flaw(value)) {
        return -EINVAL;
    }
    (void)snprintf(field, ISO_PERSON_NAME_SIZE, "%s", value);
    return 0;
}

/* Reads "WORD" or "WORD REASON". */
static int parse_answer(const char *value, void *field)
{
    static const struct {
        const char *word;
        enum cli_said said;
    } words[] = {{"yes", CLI_SAID_YES}, {"no", CLI_SAID_NO}, {"skip", CLI_SAID_SKIP}};
    struct cli_answer *answer = field;
    const size_t length = strcspn(value, " \t");
    const char *reason = value + length + strspn(value + length, " \t");

    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strlen(words[i].word) != length || strncmp(words[i].word, value, length) != 0) {
            continue;
        }
        if ((words[i].said == CLI_SAID_YES && *reason) ||
            (words[i].said == CLI_SAID_SKIP && !*reason) || iso_person_name_has_control(reason)) {
            return -EINVAL;
        }
        answer->said = words[i].said;
        (void)snprintf(answer->reason, sizeof answer->reason, "%s", reason);
        return 0;
    }
    return -EINVAL;
}

/* The relay is switched or not: "no" would say that it failed, before it was tried. */
static int parse_consent(const char *value, void *field)
{
    const int error = parse_answer(value, field);

    return error || ((const struct cli_answer *)field)->said == CLI_SAID_NO ? -EINVAL : 0;
}

/* Fills in the table of the keys. Returns how many there are. */
static size_t make_keys(struct iso_ini_key keys[KEYS])
{
    size_t n = 0;

    keys[n++] = (struct iso_ini_key){"", "by", parse_name, offsetof(struct cli_answers, by), 0};
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (cli_checklist_asks(&cli_checklist[i])) {
            keys[n++] = (struct iso_ini_key){
                "", cli_checklist[i].item,
                cli_checklist[i].way == CLI_WAY_RELAY ? parse_consent : parse_answer,
                offsetof(struct cli_answers, items) + i * sizeof(struct cli_answer), 0};
        }
    }
    return n;
}

enum cli_exit cli_answers_read(const char *path, struct cli_answers *out, struct cli_fault *fault)
{
    struct iso_ini_key keys[KEYS];
    const size_t n = make_keys(keys);
    struct iso_fault own = {.text = ""};
    uint64_t seen = 0;
    char *text = NULL;
    int error = iso_text_read(path, FILE_MAX, &text, &own);

    if (!error) {
        error = iso_ini_read(path, text, keys, n, out, &seen, &own);
    }
    free(text);
    if (error) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "bad-answers", "%s", own.text);
    }
    for (size_t i = 0; i < n; i++) {
        if (!(seen & UINT64_C(1) << i)) {
            return cli_fault_set(fault, CLI_EXIT_USAGE, "bad-answers", "%s: no answer for '%s'",
                                 path, keys[i].name);
        }
    }
    return CLI_EXIT_OK;
}

/* ---- at the terminal ---- */

enum cli_exit cli_answers_ask_name(const struct cli_dialogue *dialogue,
                                   char by[ISO_PERSON_NAME_SIZE])
{
    char name[CLI_ANSWER_SIZE];

    for (;;) {
        const enum cli_exit exit = cli_dialogue_text(dialogue, "Your name:", NULL, name);
        if (exit) {
            return exit;
        }
        const char *flaw = iso_person_name_flaw(name);
        if (!flaw) {
            (void)snprintf(by, ISO_PERSON_NAME_SIZE, "%s", name);
            return CLI_EXIT_OK;
        }
        fprintf(dialogue->out, "%s.\n", flaw);
    }
}

/* Asks for a reason until it is one line of text. */
static enum cli_exit ask_reason(const struct cli_dialogue *dialogue, const char *question,
                                const char *standard, char reason[CLI_ANSWER_SIZE])
{
    enum cli_exit exit;

    do {
        exit = cli_dialogue_text(dialogue, question, standard, reason);
    } while (!exit && iso_person_name_has_control(reason));
    return exit;
}

enum cli_exit cli_answers_ask(const struct cli_dialogue *dialogue,
                              const struct cli_checklist_item *item, struct cli_answer *out)
{
    char question[256];

    *out = (struct cli_answer){.said = CLI_SAID_SKIP};
    (void)snprintf(question, sizeof question, "%-12s %s", item->item, item->text);
    const enum cli_exit exit = cli_dialogue_said(dialogue, question, &out->said);
    if (exit || out->said == CLI_SAID_YES) {
        return exit;
    }
    if (item->way == CLI_WAY_RELAY) { /* it is not tried, which is no failure of the door */
        out->said = CLI_SAID_SKIP;
    }
    return out->said == CLI_SAID_SKIP ? ask_reason(dialogue, "  Why not?", NULL, out->reason)
                                      : ask_reason(dialogue, "  What is wrong?", "", out->reason);
}
