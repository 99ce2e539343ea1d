#include "enroll/cli/setup/show.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/doctor/examine.h"
#include "enroll/cli/machine/interrupt.h"
#include "enroll/cli/picture/picture.h"
#include "enroll/cli/picture/terminal_picture.h"

enum { ATTEMPTS = 4 };

struct png {
    uint8_t *bytes;
    size_t size;
};

/* Whether a later attempt may succeed: if another program has the camera, or if the daemon is not
 * on the bus yet. After a fault of the camera there is no other attempt, because the daemon itself
 * has waited for a frame, and it writes a record for each attempt. */
static bool may_pass(const struct cli_fault *fault)
{
    return strcmp(fault->code, "already-in-use") == 0 || strcmp(fault->code, "no-daemon") == 0;
}

static enum cli_exit fetch(const struct cli_bus *bus, struct png *out, struct cli_fault *fault)
{
    struct cli_daemon *daemon = NULL;
    enum cli_exit exit = cli_daemon_open(bus, &daemon, fault);

    for (int i = 0; !exit && i < ATTEMPTS; i++) {
        exit = cli_picture_take(daemon, &out->bytes, &out->size, fault);
        if (!exit || !may_pass(fault) || i == ATTEMPTS - 1 || cli_interrupted()) {
            break;
        }
        (void)nanosleep(&(struct timespec){.tv_sec = 1}, NULL);
        exit = CLI_EXIT_OK;
    }
    cli_daemon_close(daemon);
    return exit;
}

/* The text of the fault without "no picture: ", because the printed line says this already. */
static const char *reason_of(const struct cli_fault *fault)
{
    static const char prefix[] = "no picture: ";
    const size_t length = sizeof prefix - 1;

    return strncmp(fault->text, prefix, length) == 0 ? fault->text + length : fault->text;
}

static void show(const struct png *png, const struct cli_dialogue *dialogue)
{
    struct cli_pixels pixels = {0};
    struct cli_fault fault = {0};

    if (cli_pixels_decode(png->bytes, png->size, &pixels, &fault)) {
        fprintf(dialogue->out, "%s\n", fault.text);
    } else {
        (void)cli_terminal_show(&pixels, dialogue->in, dialogue->out);
    }
    cli_pixels_done(&pixels);
}

bool cli_setup_show_picture(const struct cli_setup_wish *wish, const struct cli_dialogue *dialogue)
{
    struct png png = {0};
    struct cli_fault fault = {0};

    fputs("Waiting for a picture ...\n", dialogue->out);
    fflush(dialogue->out);
    enum cli_exit exit = fetch(&wish->bus, &png, &fault);
    if (!exit && dialogue->terminal) {
        show(&png, dialogue);
    }
    if (!exit) {
        exit = cli_picture_save(wish->picture, png.bytes, png.size, &fault);
    }
    if (exit) {
        fprintf(dialogue->out, "There is no picture of what the camera sees: %s.\n",
                reason_of(&fault));
    } else {
        fprintf(dialogue->out, "%s: what the camera sees; delete it after use.\n", wish->picture);
    }
    if (png.bytes) {
        explicit_bzero(png.bytes, png.size);
    }
    free(png.bytes);
    return exit == CLI_EXIT_OK;
}

void cli_setup_show_diagnosis(const struct cli_setup_wish *wish,
                              const struct cli_dialogue *dialogue, struct cli_diagnosis *out)
{
    cli_doctor_examine(&wish->bus, out);
    if (!wish->json) {
        cli_diagnosis_print(out, dialogue->out);
    }
}
