/* What is wrong: the findings of `isotherm doctor` from the state of the daemon, and those of the
 * web server itself. */
#include <inttypes.h>
#include <stdlib.h>
#include <time.h>

#include "enroll/cli/doctor/diagnosis.h"
#include "enroll/cli/doctor/remedy.h"
#include "enroll/web/api/api.h"
#include "enroll/web/daemon/feed.h"
#include "enroll/web/daemon/json_text.h"

enum { WARN_DAYS = 30 };

/* Writes a member; NULL as null. */
static void write_member(FILE *out, const char *name, const char *value)
{
    (void)fprintf(out, "\"%s\":", name);
    if (value) {
        web_json_text(out, value);
    } else {
        (void)fputs("null", out);
    }
}

static void write_check(FILE *out, const char *subject, const char *state, const char *code,
                        const char *found, const char *remedy)
{
    (void)fputc('{', out);
    write_member(out, "subject", subject);
    (void)fputc(',', out);
    write_member(out, "state", state);
    (void)fputc(',', out);
    write_member(out, "code", code);
    (void)fputc(',', out);
    write_member(out, "found", found);
    (void)fputc(',', out);
    write_member(out, "remedy", remedy);
    (void)fputc('}', out);
}

/* Writes the check of the certificate. Returns whether it is good enough. */
static bool write_certificate(FILE *out, const struct web_certificate *certificate)
{
    static const char remedy[] =
        "put a new key.pem and certificate.pem into the state directory of "
        "isotherm-web, or remove both and restart it: it then makes new "
        "ones";
    const int64_t left_s = certificate->ends_s - (int64_t)time(NULL);
    char ends[WEB_TIME_TEXT_SIZE], found[64];
    (void)snprintf(found, sizeof found, "%s %s", left_s > 0 ? "valid until" : "it ended at",
                   web_time_text(certificate->ends_s, ends));
    if (left_s <= 0) {
        write_check(out, "certificate", "bad", "certificate-ended", found, remedy);
    } else if (left_s < (int64_t)WARN_DAYS * 86400) {
        write_check(out, "certificate", "odd", "certificate-ends", found, remedy);
    } else {
        write_check(out, "certificate", "good", NULL, found, NULL);
    }
    return left_s > 0;
}

/* Writes the answer. */
static void write_health(const struct web_api *api, FILE *out)
{
    static const char *const states[] = {
        [CLI_CHECK_GOOD] = "good",
        [CLI_CHECK_ODD] = "odd",
        [CLI_CHECK_DENIED] = "denied",
        [CLI_CHECK_BAD] = "bad",
    };
    const json_t *status = web_feed_status(api->feed);
    struct cli_diagnosis diagnosis = {.n_findings = 0};
    if (status) {
        cli_diagnosis_judge(&diagnosis, status);
    } else {
        cli_diagnosis_add(&diagnosis, "daemon", CLI_CHECK_BAD, ISO_FAULT_NO_DAEMON, "");
    }
    (void)fputs("{\"checks\":[", out);
    for (size_t i = 0; i < diagnosis.n_findings; i++) {
        const struct cli_finding *finding = &diagnosis.findings[i];
        const char *code = finding->code == ISO_FAULT_NONE ? NULL
                                                           : iso_fault_code_name(finding->code);
        write_check(out, finding->subject, states[finding->check], code, finding->found,
                    cli_remedy(finding->code));
        (void)fputc(',', out);
    }
    const bool has_certificate = write_certificate(out, api->certificate);
    const bool healthy = has_certificate && cli_diagnosis_exit(&diagnosis) == CLI_EXIT_OK;
    (void)fprintf(out, "],\"healthy\":%s,\"version\":\"%s\",\"certificate\":{",
                  healthy ? "true" : "false", ISOTHERM_VERSION);
    write_member(out, "fingerprint", api->certificate->fingerprint);
    (void)fprintf(out, ",\"ends_s\":%" PRId64 "},\"history\":", api->certificate->ends_s);
    web_feed_write_history(api->feed, out);
    (void)fputc('}', out);
}

void web_api_get_health(void *context, struct web_exchange *exchange)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out) {
        write_health(context, out);
        if (fclose(out) != 0) {
            free(text);
            text = NULL;
        }
    }
    web_exchange_text(exchange, 200, text, size);
}
