#include "tests/fuzz/enroll/web_stand_in.h"

#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "enroll/web/daemon/daemon.h"
#include "enroll/web/http/exchange.h"
#include "enroll/web/http/server.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/person_name.h"
#include "tests/fuzz/fuzz.h"

enum { DUE_MOST = 16 };

struct web_stand_in web_stand_in;

static struct due {
    web_daemon_reply_fn on_reply;
    void *context;
    bool fails;
} due[DUE_MOST];

/* ---- the daemon ---- */

struct web_daemon {
    sd_bus *bus; /* which is never connected: it makes messages */
};

const sd_bus_error web_daemon_is_gone = SD_BUS_ERROR_MAKE_CONST(SD_BUS_ERROR_SERVICE_UNKNOWN,
                                                                "there is no daemon");

void web_stand_in_reset(bool refuses)
{
    fuzz_check(web_stand_in.n_due == 0, "no answer is owed");
    web_stand_in = (struct web_stand_in){.refuses = refuses};
}

static void owe(web_daemon_reply_fn on_reply, void *context, bool fails)
{
    fuzz_check(web_stand_in.n_due < DUE_MOST, "there are few calls at one time");
    due[web_stand_in.n_due++] = (struct due){on_reply, context, fails};
}

void web_stand_in_answer(void)
{
    struct due now[DUE_MOST];
    const int n = web_stand_in.n_due;

    memcpy(now, due, sizeof now);
    web_stand_in.n_due = 0;
    for (int i = 0; i < n; i++) {
        now[i].on_reply(now[i].context, NULL, now[i].fails ? &web_daemon_is_gone : NULL);
    }
}

int web_daemon_new(sd_event *event, const char *address, struct web_daemon **out)
{
    static struct web_daemon daemon;
    static int fds[2];

    (void)event;
    (void)address;
    fuzz_check(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, fds) == 0 &&
                   sd_bus_new(&daemon.bus) >= 0 && sd_bus_set_fd(daemon.bus, fds[0], fds[0]) >= 0 &&
                   sd_bus_start(daemon.bus) >= 0,
               "there is a bus for messages");
    *out = &daemon;
    return 0;
}

void web_daemon_close(struct web_daemon *daemon)
{
    (void)daemon;
}

void web_daemon_free(struct web_daemon *daemon)
{
    (void)daemon;
}

void web_daemon_listen(struct web_daemon *daemon, struct web_daemon_listener *listener)
{
    (void)daemon;
    (void)listener;
}

void web_daemon_unlisten(struct web_daemon *daemon, struct web_daemon_listener *listener)
{
    (void)daemon;
    (void)listener;
}

bool web_daemon_is_there(const struct web_daemon *daemon)
{
    (void)daemon;
    return true;
}

size_t web_daemon_waiting(const struct web_daemon *daemon)
{
    (void)daemon;
    return 0;
}

sd_bus_message *web_daemon_message(struct web_daemon *daemon, const char *method)
{
    sd_bus_message *call = NULL;

    fuzz_check(sd_bus_message_new_method_call(daemon->bus, &call, ISO_CONTRACT_NAME,
                                              ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                              method) >= 0,
               "a call can be made");
    return call;
}

/* The daemon checks again, but what it would refuse should not be asked. */
static void check_call(sd_bus_message *call)
{
    static const char *const reading[] = {ISO_CONTRACT_LIST_PEOPLE, ISO_CONTRACT_READ_LOG,
                                          ISO_CONTRACT_VERIFY_LOG};
    const char *old = NULL, *name = NULL;

    web_stand_in.n_calls++;
    web_stand_in.changes = true;
    for (size_t i = 0; i < sizeof reading / sizeof *reading; i++) {
        if (sd_bus_message_is_method_call(call, ISO_CONTRACT_INTERFACE, reading[i]) > 0) {
            web_stand_in.changes = false;
        }
    }
    if (sd_bus_message_is_method_call(call, ISO_CONTRACT_INTERFACE, ISO_CONTRACT_CLAIM) > 0) {
        web_stand_in.claimed = true;
    }
    fuzz_check(sd_bus_message_seal(call, 1, 0) >= 0, "a call is complete");
    if (sd_bus_message_is_method_call(call, ISO_CONTRACT_INTERFACE, ISO_CONTRACT_RENAME_PERSON) >
        0) {
        fuzz_check(sd_bus_message_read(call, "ss", &old, &name) > 0 && !iso_person_name_flaw(name),
                   "a new name is one that a person may have");
    }
}

void web_daemon_send(struct web_daemon *daemon, sd_bus_message *call, uint64_t timeout_us,
                     web_daemon_reply_fn on_reply, void *context)
{
    (void)daemon;
    (void)timeout_us;
    if (call) {
        check_call(call);
        sd_bus_message_unref(call);
    }
    owe(on_reply, context, true);
}

void web_daemon_record(struct web_daemon *daemon, const char *account, const char *act,
                       const char *person, web_daemon_reply_fn on_reply, void *context)
{
    (void)daemon;
    fuzz_check(strcmp(account, "ada") == 0 ||
                   (strcmp(account, "eve") == 0 && strcmp(act, "login") == 0),
               "the account of the session, or who logs in, is on record");
    fuzz_check(strlen(act) <= ISO_CONTRACT_ACT_BYTES, "an act has its length");
    fuzz_check(!*person || !iso_person_name_flaw(person), "a name on record is one");
    web_stand_in.n_records++;
    owe(on_reply, context, web_stand_in.refuses);
}

/* ---- the exchange ---- */

const char *web_exchange_part(const struct web_exchange *exchange)
{
    return exchange->part;
}

const char *web_exchange_query(const struct web_exchange *exchange, const char *name)
{
    (void)exchange;
    (void)name;
    return NULL;
}

json_t *web_exchange_body(const struct web_exchange *exchange)
{
    return exchange->body;
}

const char *web_exchange_account(const struct web_exchange *exchange)
{
    return exchange->account;
}

enum web_role web_exchange_role(const struct web_exchange *exchange)
{
    return exchange->role;
}

uint64_t web_exchange_session(const struct web_exchange *exchange)
{
    return exchange->session;
}

const struct sockaddr *web_exchange_address(const struct web_exchange *exchange)
{
    static const struct sockaddr_storage address = {.ss_family = AF_INET};
    (void)exchange;
    return (const struct sockaddr *)&address;
}

void web_exchange_json(struct web_exchange *exchange, unsigned status, json_t *json)
{
    fuzz_check(json != NULL, "there is an answer");
    exchange->answers++;
    exchange->status = status;
    json_decref(exchange->json);
    exchange->json = json;
}

void web_exchange_text(struct web_exchange *exchange, unsigned status, char *text, size_t size)
{
    web_exchange_json(exchange, text ? status : 500,
                      text ? json_loadb(text, size, JSON_DECODE_ANY, NULL) : json_null());
    free(text);
}

void web_exchange_done(struct web_exchange *exchange)
{
    web_exchange_json(exchange, 204, json_null());
}

void web_exchange_problem(struct web_exchange *exchange, unsigned status, const char *code,
                          const char *detail)
{
    web_exchange_json(exchange, status, json_pack("{s:s, s:s}", "code", code, "detail", detail));
}

/* Of an intake (route.h), which begins before there is a body. */
void web_exchange_refuse(struct web_exchange *exchange, unsigned status, const char *code,
                         const char *detail)
{
    (void)exchange;
    (void)status;
    (void)code;
    (void)detail;
    fuzz_check(false, "a handler of a body does not begin an intake");
}

void web_exchange_header(struct web_exchange *exchange, const char *name, const char *value)
{
    (void)exchange;
    fuzz_check(strlen(name) < 32 && strlen(value) < 192, "a header has its length");
}

struct web_stream *web_exchange_stream(struct web_exchange *exchange, const char *content_type,
                                       enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context)
{
    (void)content_type;
    (void)kind;
    (void)on_closed;
    (void)context;
    web_exchange_problem(exchange, 500, "internal", "no stream begins with a body");
    return NULL;
}

/* ---- streams and the server, which no body reaches ---- */

void web_stream_send(struct web_stream *stream, struct web_chunk *chunk)
{
    (void)stream;
    (void)chunk;
}

uint64_t web_stream_dropped(const struct web_stream *stream)
{
    (void)stream;
    return 0;
}

void web_stream_end(struct web_stream *stream)
{
    (void)stream;
}

void web_server_end_stale_streams(struct web_server *server)
{
    (void)server;
}

int web_server_streams(const struct web_server *server)
{
    (void)server;
    return 0;
}

/* ---- the hash of a password, which takes a tenth of a second on purpose ---- */

int crypto_pwhash_str_alg(char out[128], const char *password, unsigned long long size,
                          unsigned long long passes, size_t bytes, int algorithm)
{
    (void)password;
    (void)size;
    (void)passes;
    (void)bytes;
    (void)algorithm;
    memset(out, 0, 128);
    strcpy(out, "$argon2id$v=19$m=19456,t=2,p=1$BBBBBBBBBBBBBBBBBBBBBB$"
                "BBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBBB");
    return 0;
}

int crypto_pwhash_str_verify(const char *hash, const char *password, unsigned long long size)
{
    (void)hash;
    return size == 16 && memcmp(password, "correct password", 16) == 0 ? 0 : -1;
}
