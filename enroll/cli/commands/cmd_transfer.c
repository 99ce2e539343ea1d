/* export and import: copy people as one sealed, signed file. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sodium.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "drivers/terminal/words.h"
#include "enroll/cli/client/long_call.h"
#include "enroll/cli/commands/commands.h"
#include "enroll/cli/text/passphrase.h"
#include "enroll/cli/text/report.h"
#include "firmware/contract/contract.h"

static int append_text(sd_bus_message *call, const char *name, const char *text)
{
    return text ? sd_bus_message_append(call, "{sv}", name, "s", text) : 0;
}

static int append_bytes(sd_bus_message *call, const char *name, const void *bytes, size_t size)
{
    int r = sd_bus_message_open_container(call, 'e', "sv");
    if (r >= 0) {
        r = sd_bus_message_append_basic(call, 's', name);
    }
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'v', "ay");
    }
    if (r >= 0) {
        r = sd_bus_message_append_array(call, 'y', bytes, size);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(call);
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

static enum cli_exit file_fault(struct cli_fault *fault, const char *path)
{
    return cli_fault_set(fault, errno == ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT, "file",
                         "%s: %s", path, strerror(errno));
}

static enum cli_exit start_crypto(struct cli_fault *fault)
{
    return sodium_init() < 0
               ? cli_fault_set(fault, CLI_EXIT_FAULT, "internal", "libsodium does not start")
               : CLI_EXIT_OK;
}

/* ---- export ---- */

static int append_lock(sd_bus_message *call, const struct cli_arguments *arguments,
                       const uint8_t *salt, const uint8_t *key)
{
    int r = sd_bus_message_open_container(call, 'a', "{sv}");
    if (r >= 0 && arguments->address) {
        r = append_text(call, ISO_CONTRACT_TO, arguments->address);
    } else if (r >= 0) {
        r = append_bytes(call, ISO_CONTRACT_SALT, salt, CLI_SALT_BYTES);
        if (r >= 0) {
            r = append_bytes(call, ISO_CONTRACT_KEY, key, CLI_KEY_BYTES);
        }
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

static enum cli_exit call_export(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                 int fd, const uint8_t *salt, const uint8_t *key, uint32_t *n,
                                 struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_EXPORT_PEOPLE, &call, fault);
    if (exit) {
        return exit;
    }
    (void)sd_bus_message_sensitive(call);
    int r = sd_bus_message_append(call, "h", fd);
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'a', "s");
    }
    for (size_t i = 0; r >= 0 && i < arguments->n_people; i++) {
        r = sd_bus_message_append_basic(call, 's', arguments->people[i]);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(call);
    }
    if (r >= 0) {
        r = append_lock(call, arguments, salt, key);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_EXPORT_PEOPLE, fault);
    }
    exit = cli_long_call(daemon, call, "exporting people", &reply, fault);
    if (!exit && (r = sd_bus_message_read(reply, "u", n)) < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_EXPORT_PEOPLE, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_export(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    uint8_t salt[CLI_SALT_BYTES], key[CLI_KEY_BYTES] = {0};
    uint32_t n = 0;
    enum cli_exit exit = start_crypto(fault);
    if (exit) {
        return exit;
    }
    const int fd = open(arguments->word, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0) {
        return file_fault(fault, arguments->word);
    }
    randombytes_buf(salt, sizeof salt);
    if (!arguments->address) {
        exit = cli_passphrase_key(arguments->passphrase_file, true, salt, key, fault);
    }
    if (!exit) {
        exit = call_export(daemon, arguments, fd, salt, key, &n, fault);
    }
    sodium_memzero(key, sizeof key);
    (void)close(fd);
    if (exit) {
        (void)unlink(arguments->word);
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(
            json_pack("{s:s, s:I}", "file", arguments->word, "people", (json_int_t)n));
    }
    printf("%s holds %" PRIu32 " %s, sealed.\n", arguments->word, n,
           iso_plural(n, "person", "people"));
    return CLI_EXIT_OK;
}

/* ---- import ---- */

/* Derives the key if a passphrase opens the file. */
static enum cli_exit find_key(int fd, const struct cli_arguments *arguments,
                              uint8_t key[CLI_KEY_BYTES], bool *has_key, struct cli_fault *fault)
{
    uint8_t header[ISO_CONTRACT_PEOPLE_SALT_AT + CLI_SALT_BYTES];
    if (pread(fd, header, sizeof header, 0) != sizeof header ||
        memcmp(header, ISO_CONTRACT_PEOPLE_MAGIC, strlen(ISO_CONTRACT_PEOPLE_MAGIC)) != 0) {
        return cli_fault_set(fault, CLI_EXIT_FAULT, "file", "%s: holds no exported people",
                             arguments->word);
    }
    *has_key = header[ISO_CONTRACT_PEOPLE_LOCK_AT] == ISO_CONTRACT_PEOPLE_PASSPHRASE;
    return *has_key ? cli_passphrase_key(arguments->passphrase_file, false,
                                         header + ISO_CONTRACT_PEOPLE_SALT_AT, key, fault)
                    : CLI_EXIT_OK;
}

static enum cli_exit call_import(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                 int fd, const uint8_t *key, uint32_t count[2],
                                 struct cli_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    enum cli_exit exit = cli_daemon_message(daemon, ISO_CONTRACT_IMPORT_PEOPLE, &call, fault);
    if (exit) {
        return exit;
    }
    (void)sd_bus_message_sensitive(call);
    int r = sd_bus_message_append(call, "h", fd);
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'a', "{sv}");
    }
    if (r >= 0) {
        r = append_text(call, ISO_CONTRACT_FROM, arguments->address);
    }
    if (r >= 0 && key) {
        r = append_bytes(call, ISO_CONTRACT_KEY, key, CLI_KEY_BYTES);
    }
    if (r >= 0) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_REPLACE, "b", arguments->replace);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(call);
    }
    if (r < 0) {
        sd_bus_message_unref(call);
        return cli_daemon_bad_reply(r, ISO_CONTRACT_IMPORT_PEOPLE, fault);
    }
    exit = cli_long_call(daemon, call, "importing people", &reply, fault);
    if (!exit && (r = sd_bus_message_read(reply, "uu", &count[0], &count[1])) < 0) {
        exit = cli_daemon_bad_reply(r, ISO_CONTRACT_IMPORT_PEOPLE, fault);
    }
    sd_bus_message_unref(reply);
    return exit;
}

enum cli_exit cli_import(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault)
{
    uint8_t key[CLI_KEY_BYTES] = {0};
    uint32_t count[2] = {0, 0};
    bool has_key = false;
    enum cli_exit exit = start_crypto(fault);
    if (exit) {
        return exit;
    }
    struct iso_fault why = {.text = ""};
    int fd = -1;
    const int error = iso_file_open(arguments->word, O_RDONLY, ISO_FILE_ANY_SIZE, &fd, &why);
    if (error) {
        return cli_fault_set(fault, error == -ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT, "file",
                             "%s", why.text);
    }
    exit = find_key(fd, arguments, key, &has_key, fault);
    if (!exit) {
        exit = call_import(daemon, arguments, fd, has_key ? key : NULL, count, fault);
    }
    sodium_memzero(key, sizeof key);
    (void)close(fd);
    if (exit) {
        return exit;
    }
    if (arguments->json) {
        return cli_report_json(
            json_pack("{s:I, s:I}", "added", (json_int_t)count[0], "known", (json_int_t)count[1]));
    }
    if (arguments->replace) {
        /* The daemon counts new and replaced people together. */
        printf("%" PRIu32 " %s added or replaced.\n", count[0],
               iso_plural(count[0], "person", "people"));
        return CLI_EXIT_OK;
    }
    printf("%" PRIu32 " %s added, %" PRIu32 " %s.\n", count[0],
           iso_plural(count[0], "person", "people"), count[1],
           iso_plural(count[1], "was known and stays as is", "were known and stay as they are"));
    return CLI_EXIT_OK;
}
