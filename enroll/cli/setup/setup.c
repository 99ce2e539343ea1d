#include "enroll/cli/setup/setup.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/machine/interrupt.h"
#include "enroll/cli/machine/text_file.h"
#include "enroll/cli/setup/choose.h"
#include "enroll/cli/setup/compose.h"
#include "enroll/cli/setup/difference.h"
#include "enroll/cli/setup/install.h"
#include "enroll/cli/setup/show.h"
#include "enroll/cli/text/report.h"

/* The file of a dry run is written beside this path, where isothermd can read it. */
static const char dry_place[] = "/tmp/isotherm.conf";

struct plan {
    struct cli_setup_choice choice;
    char *old_text; /* NULL: there is no file */
    char *text;
    bool same; /* true: nothing has to be written */
};

/* ---- the plan ---- */

static enum cli_exit make_plan(const struct cli_setup_places *places,
                               const struct cli_setup_wish *wish,
                               const struct cli_dialogue *dialogue, struct plan *plan,
                               struct cli_fault *fault)
{
    const enum cli_exit exit = cli_setup_choose(places, wish, dialogue, &plan->choice, fault);

    if (exit) {
        return exit;
    }
    struct iso_fault why = {.text = ""};
    plan->old_text = cli_text_file_read(places->config, &why);
    if (!plan->old_text && errno != ENOENT) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "no-file", "%s", why.text);
    }
    plan->text = cli_compose(&(struct cli_composition){
        .board = plan->choice.board.name,
        .board_text = plan->choice.board_text,
        .sensor = &plan->choice.sensor,
        .old_text = plan->old_text,
    });
    if (!plan->text) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "%s", strerror(ENOMEM));
    }
    plan->same = plan->old_text && strcmp(plan->old_text, plan->text) == 0;
    return CLI_EXIT_OK;
}

static void plan_done(struct plan *plan)
{
    free(plan->choice.board_text);
    free(plan->old_text);
    free(plan->text);
}

static enum cli_exit show_plan(const struct cli_setup_places *places, const struct plan *plan,
                               FILE *out, struct cli_fault *fault)
{
    if (plan->same) {
        fprintf(out, "%s stays as it is.\n", places->config);
        return CLI_EXIT_OK;
    }
    fprintf(out, plan->old_text ? "This changes in %s:\n\n" : "This is the new %s:\n\n",
            places->config);
    if (!plan->old_text) {
        fprintf(out, "%s\n", plan->text);
        return CLI_EXIT_OK;
    }
    const int error = cli_difference_print(plan->old_text, plan->text, out);
    fputc('\n', out);
    return error ? cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "%s", strerror(-error))
                 : CLI_EXIT_OK;
}

static enum cli_exit confirm(const struct cli_setup_wish *wish, const struct plan *plan,
                             const struct cli_dialogue *dialogue, struct cli_fault *fault)
{
    bool yes = false;

    if (wish->yes) {
        return CLI_EXIT_OK;
    }
    if (!dialogue->terminal) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "usage",
                             "there is no terminal to ask at: give --yes, or --dry-run to look "
                             "only");
    }
    const enum cli_exit exit = cli_dialogue_yes(
        dialogue, plan->same ? "Start the service again?" : "Write it and start the service?", true,
        &yes);
    return exit || yes
               ? exit
               : cli_fault_set(fault, CLI_EXIT_NO, "not-wanted", "nothing has been changed");
}

/* ---- the result ---- */

static enum cli_exit report(const struct cli_setup_places *places,
                            const struct cli_setup_wish *wish, const struct plan *plan,
                            const char *backup, bool has_picture,
                            const struct cli_diagnosis *diagnosis)
{
    return cli_report_json(json_pack("{s:s, s:s, s:s, s:s?, s:s?, s:o?}", "config", places->config,
                                     "board", plan->choice.board.name, "sensor",
                                     plan->choice.sensor.backend, "backup", *backup ? backup : NULL,
                                     "picture", has_picture ? wish->picture : NULL, "doctor",
                                     diagnosis ? cli_diagnosis_json(diagnosis) : NULL));
}

static enum cli_exit finish(const struct cli_setup_places *places,
                            const struct cli_setup_wish *wish, const struct plan *plan,
                            const char *backup, const struct cli_dialogue *dialogue)
{
    struct cli_diagnosis diagnosis = {0};

    fprintf(dialogue->out, "%s runs.", places->unit);
    if (*backup) {
        fprintf(dialogue->out, " The old file is now %s.", backup);
    }
    fputc('\n', dialogue->out);
    const bool has_picture = cli_setup_show_picture(wish, dialogue);
    cli_setup_show_diagnosis(wish, dialogue, &diagnosis);
    return wish->json ? report(places, wish, plan, backup, has_picture, &diagnosis) : CLI_EXIT_OK;
}

static enum cli_exit carry_out(const struct cli_setup_places *places,
                               const struct cli_setup_wish *wish, const struct plan *plan,
                               const struct cli_dialogue *dialogue, struct cli_fault *fault)
{
    char backup[PATH_MAX] = "";
    enum cli_exit exit = show_plan(places, plan, dialogue->out, fault);

    if (!exit && wish->dry_run) {
        exit = cli_setup_check(places, dry_place, plan->text, fault);
        if (!exit && wish->json) {
            exit = report(places, wish, plan, backup, false, NULL);
        }
        return exit;
    }
    if (!exit) {
        exit = confirm(wish, plan, dialogue, fault);
    }
    if (!exit) {
        fprintf(dialogue->out, "Starting %s ...\n", places->unit);
        (void)fflush(dialogue->out);
        exit = cli_setup_install(places, &wish->bus, plan->same ? NULL : plan->text, backup, fault);
    }
    return exit ? exit : finish(places, wish, plan, backup, dialogue);
}

enum cli_exit cli_setup_run(const struct cli_setup_places *places,
                            const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue,
                            struct cli_fault *fault)
{
    struct plan plan = {.text = NULL};

    if (places->root && !wish->dry_run && geteuid() != 0) {
        return cli_fault_set(fault, CLI_EXIT_NO, "access-denied",
                             "setup writes %.100s and starts the service: only root may (sudo "
                             "isotherm setup)",
                             places->config);
    }
    cli_interrupt_catch();
    enum cli_exit exit = make_plan(places, wish, dialogue, &plan, fault);
    if (!exit) {
        exit = carry_out(places, wish, &plan, dialogue, fault);
    }
    plan_done(&plan);
    if (exit == CLI_EXIT_INTERRUPTED && !fault->text[0]) {
        (void)cli_fault_set(fault, exit, "interrupted", "interrupted; nothing has been changed");
    }
    return exit;
}
