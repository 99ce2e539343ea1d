/* The parts of isotherm doctor --commission that need no daemon: the checklist is that of the page,
 * answers are read strictly and asked for until they are answers, and a remark is one line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/commission/answers.h"
#include "enroll/cli/commission/results.h"
#include "tests/support/scratch.h"

static const char page[] = ISOTHERM_SOURCE_DIR "/board/commissioning.md";

/* ---- the list and the page ---- */

/* Each item has a row "| `item` | machine | text |" in the page, in the order of the list, and the
 * page has no other rows of this form. */
static void the_page_shows_the_checklist(void **state)
{
    char *text = scratch_read_text(page), row[512];
    const char *at = text;
    size_t rows = 0;

    (void)state;
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        (void)snprintf(row, sizeof row, "\n| `%s` | %s | %s |\n", cli_checklist[i].item,
                       cli_checklist[i].way == CLI_WAY_PERSON ? "person" : "machine",
                       cli_checklist[i].text);
        const char *found = strstr(at, row);
        if (!found) {
            fail_msg("%s does not have, or not in this place:%s", page, row);
        }
        at = found + 1;
    }
    for (at = text; (at = strstr(at, "\n| `")); at++) {
        rows++;
    }
    assert_int_equal(rows, CLI_CHECKLIST_ITEMS);
    free(text);
}

static void items_are_words_that_the_daemon_accepts(void **state)
{
    static const char allowed[] = "abcdefghijklmnopqrstuvwxyz0123456789.-_";

    (void)state;
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        const char *item = cli_checklist[i].item;
        assert_true(*item && strlen(item) <= ISO_CONTRACT_ITEM_BYTES);
        assert_int_equal(strspn(item, allowed), strlen(item));
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(cli_checklist[k].item, item);
        }
    }
    assert_true(CLI_CHECKLIST_ITEMS <= (int)ISO_CONTRACT_ITEMS_MAX);
}

/* ---- answers from a file ---- */

/* Writes a file in which every item that asks has the answer "yes", but `changed` has `answer`;
 * NULL: it has no line. */
static void write_answers(const char *path, const char *changed, const char *answer)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    assert_non_null(out);
    if (strcmp(changed, "by") != 0) {
        fputs("by = Ada Example\n", out);
    } else if (answer) {
        fprintf(out, "by = %s\n", answer);
    }
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        const bool is_changed = strcmp(cli_checklist[i].item, changed) == 0;
        if ((cli_checklist_asks(&cli_checklist[i]) && !is_changed) || (is_changed && answer)) {
            fprintf(out, "%s = %s\n", cli_checklist[i].item, is_changed ? answer : "yes");
        }
    }
    assert_int_equal(fclose(out), 0);
    scratch_write_text(path, text);
    free(text);
}

static const struct cli_answer *answer_to(const struct cli_answers *answers, const char *item)
{
    for (size_t i = 0; i < CLI_CHECKLIST_ITEMS; i++) {
        if (strcmp(cli_checklist[i].item, item) == 0) {
            return &answers->items[i];
        }
    }
    fail_msg("no item '%s'", item);
    return NULL;
}

static void answers_are_read_from_a_file(void **state)
{
    const char *path = scratch_path(*state, "answers");
    struct cli_answers answers = {.by = ""};
    struct cli_fault fault = {.text = ""};

    write_answers(path, "photo", "no it was let in");
    assert_int_equal(cli_answers_read(path, &answers, &fault), CLI_EXIT_OK);
    assert_string_equal(answers.by, "Ada Example");
    assert_int_equal(answer_to(&answers, "photo")->said, CLI_SAID_NO);
    assert_string_equal(answer_to(&answers, "photo")->reason, "it was let in");
    assert_int_equal(answer_to(&answers, "relay")->said, CLI_SAID_YES);
    write_answers(path, "relay", "skip nobody stands at the door");
    assert_int_equal(cli_answers_read(path, &answers, &fault), CLI_EXIT_OK);
    assert_int_equal(answer_to(&answers, "relay")->said, CLI_SAID_SKIP);
    assert_string_equal(answer_to(&answers, "relay")->reason, "nobody stands at the door");
}

static void a_wrong_file_of_answers_is_refused(void **state)
{
    static const struct {
        const char *item, *answer, *says;
    } cases[] = {
        {"photo", NULL, "no answer for 'photo'"},
        {"by", NULL, "no answer for 'by'"},
        {"by", "a name that goes on for more than sixty-four characters, which none may",
         "bad value"},
        {"photo", "maybe", "bad value 'maybe' for photo"},
        {"photo", "yes but only once", "bad value"},
        {"photo", "yesterday", "bad value"},
        {"photo", "skip", "bad value 'skip' for photo"},
        {"photo", "no \x1b[2J", "bad value"},
        {"relay", "no", "bad value 'no' for relay"},
        {"sensor", "yes", "unknown key 'sensor'"},
    };
    const char *path = scratch_path(*state, "answers");

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct cli_answers answers = {.by = ""};
        struct cli_fault fault = {.text = ""};
        write_answers(path, cases[i].item, cases[i].answer);
        assert_int_equal(cli_answers_read(path, &answers, &fault), CLI_EXIT_USAGE);
        assert_string_equal(fault.code, "bad-answers");
        if (!strstr(fault.text, cases[i].says) || !strstr(fault.text, path)) {
            fail_msg("%s = %s: %s", cases[i].item, cases[i].answer, fault.text);
        }
    }
    struct cli_answers answers;
    struct cli_fault fault = {.text = ""};
    assert_int_equal(cli_answers_read("/nonexistent/answers", &answers, &fault), CLI_EXIT_USAGE);
    assert_non_null(strstr(fault.text, "/nonexistent/answers"));
}

/* ---- answers at the terminal ---- */

/* Lets cli_answers_ask() read `typed`. Returns what it printed, to be freed. */
static char *ask(const char *item, const char *typed, struct cli_answer *answer,
                 enum cli_exit expected)
{
    const struct cli_checklist_item *asked = cli_checklist;
    char *text = NULL;
    size_t size;
    int ends[2];

    while (strcmp(asked->item, item) != 0) {
        asked++;
    }
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], typed, strlen(typed)), strlen(typed));
    close(ends[1]);
    const struct cli_dialogue dialogue = {ends[0], open_memstream(&text, &size), true};
    assert_non_null(dialogue.out);
    assert_int_equal(cli_answers_ask(&dialogue, asked, answer), expected);
    assert_int_equal(fclose(dialogue.out), 0);
    close(ends[0]);
    return text;
}

static void a_person_is_asked_until_the_answer_is_one(void **state)
{
    struct cli_answer answer;
    char *text = ask("photo", "\nperhaps\nY\n", &answer, CLI_EXIT_OK);

    (void)state;
    assert_int_equal(answer.said, CLI_SAID_YES);
    assert_non_null(strstr(text, "photo        Does it stay locked for a printed photo of an "
                                 "enrolled person? [y/n/skip] Please answer y, n or skip.\n"));
    free(text);
    free(ask("photo", "no\nit was let in\n", &answer, CLI_EXIT_OK));
    assert_int_equal(answer.said, CLI_SAID_NO);
    assert_string_equal(answer.reason, "it was let in");
    free(ask("photo", "n\n\n", &answer, CLI_EXIT_OK));
    assert_string_equal(answer.reason, "");
    free(ask("photo", "skip\n\n\x1b[2J\nno printer\n", &answer, CLI_EXIT_OK));
    assert_int_equal(answer.said, CLI_SAID_SKIP);
    assert_string_equal(answer.reason, "no printer");
    free(ask("photo", "skip\n", &answer, CLI_EXIT_INTERRUPTED));
}

/* Nothing has failed if the relay was not tried. */
static void a_relay_that_must_not_be_switched_is_skipped(void **state)
{
    struct cli_answer answer;

    (void)state;
    free(ask("relay", "n\nnobody stands at the door\n", &answer, CLI_EXIT_OK));
    assert_int_equal(answer.said, CLI_SAID_SKIP);
    assert_string_equal(answer.reason, "nobody stands at the door");
}

/* ---- remarks ---- */

/* A text that was cut within a character, or that has a line end, would be refused by the bus or by
 * the daemon, and the answers of an hour would be lost. */
static void a_remark_is_one_line_of_text(void **state)
{
    struct cli_result_of_check result;
    char longest[2 * ISO_CONTRACT_REMARK_BYTES];

    (void)state;
    cli_results_set(&result, ISO_CONTRACT_ANSWER_OK, "T\xc3\xbcr");
    assert_string_equal(result.remark, "T\xc3\xbcr");
    cli_results_set(&result, ISO_CONTRACT_ANSWER_OK, "T\xc3\xbcr\nzu");
    assert_string_equal(result.remark, "T??r?zu");
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    memcpy(longest + ISO_CONTRACT_REMARK_BYTES - 1, "\xc3\xbc", 2);
    cli_results_set(&result, ISO_CONTRACT_ANSWER_OK, longest);
    assert_int_equal(strlen(result.remark), ISO_CONTRACT_REMARK_BYTES);
    assert_int_equal(result.remark[ISO_CONTRACT_REMARK_BYTES - 1], '?');
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_shows_the_checklist),
        cmocka_unit_test(items_are_words_that_the_daemon_accepts),
        cmocka_unit_test(answers_are_read_from_a_file),
        cmocka_unit_test(a_wrong_file_of_answers_is_refused),
        cmocka_unit_test(a_person_is_asked_until_the_answer_is_one),
        cmocka_unit_test(a_relay_that_must_not_be_switched_is_skipped),
        cmocka_unit_test(a_remark_is_one_line_of_text),
    };

    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
