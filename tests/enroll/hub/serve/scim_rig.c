#include "tests/enroll/hub/serve/scim_rig.h"

#include <curl/curl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/hub/directory/hub_directory.h"
#include "enroll/hub/people/hub_request.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_zone.h"
#include "tests/support/scratch.h"

char scim_token[HUB_SCIM_TOKEN_SIZE], scim_headers[2048];
static CURL *curl;
static struct iso_fleet_id gate;

int scim_rig_setup(void **state)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_id lab;
    char code[HUB_CODE_SIZE];

    curl = curl_easy_init();
    assert_int_equal(served_door_setup(state), 0);
    if (rig.hubs[0].pid == 0) {
        return 0;
    }
    served_ok(hub_zone_add(&rig.store, "Lab", &lab, &fault), &fault);
    served_ok(hub_door_add(&rig.store, "Side", &rig.zone, 1, &gate, code, &fault), &fault);
    served_ok(hub_scim_token_make(&rig.store, "entra", scim_token, &fault), &fault);
    return 0;
}

int scim_rig_teardown(void **state)
{
    curl_easy_cleanup(curl);
    return served_door_teardown(state);
}

static size_t take_header(char *bytes, size_t size, size_t n, void *context)
{
    const size_t at = strlen(scim_headers);

    (void)context;
    (void)snprintf(scim_headers + at, sizeof scim_headers - at, "%.*s", (int)(size * n), bytes);
    return size * n;
}

static struct curl_slist *headers_of(const char *header)
{
    char authorization[128];
    const bool typed = header && strncmp(header, "Content-Type", 12) == 0;
    struct curl_slist *list = NULL;

    if (!typed) {
        list = curl_slist_append(list, "Content-Type: application/scim+json; charset=utf-8");
    }
    (void)snprintf(authorization, sizeof authorization, "Authorization: Bearer %s", scim_token);
    list = *scim_token ? curl_slist_append(list, authorization) : list;
    return header ? curl_slist_append(list, header) : list;
}

long scim_ask(const char *method, const char *path, const char *body, const char *header,
              json_t **json)
{
    struct door_reply reply = {.bytes = calloc(1, 1)};
    struct curl_slist *headers = headers_of(header);
    char url[512], *quoted = body ? strdup(body) : NULL;
    long status = 0;

    for (char *at = quoted; at && *at; at++) {
        *at = *at == '\'' ? '"' : *at;
    }
    scim_headers[0] = '\0';
    (void)snprintf(url, sizeof url, "https://127.0.0.1:%u/scim/v2/%s", rig.hubs[0].port, path);
    curl_easy_reset(curl);
    (void)curl_easy_setopt(curl, CURLOPT_URL, url);
    (void)curl_easy_setopt(curl, CURLOPT_CAINFO, scratch_path(rig.folder, "ca.pem"));
    (void)curl_easy_setopt(curl, CURLOPT_HTTPHEADER, headers);
    if (quoted) {
        (void)curl_easy_setopt(curl, CURLOPT_POSTFIELDS, quoted);
    }
    (void)curl_easy_setopt(curl, CURLOPT_CUSTOMREQUEST, method);
    (void)curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, take_header);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, door_reply_add);
    (void)curl_easy_setopt(curl, CURLOPT_WRITEDATA, &reply);
    (void)curl_easy_setopt(curl, CURLOPT_NOPROXY, "*");
    assert_int_equal(curl_easy_perform(curl), CURLE_OK);
    (void)curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &status);
    if (json) {
        *json = json_loads(reply.bytes, 0, NULL);
    }
    curl_slist_free_all(headers);
    free(reply.bytes);
    free(quoted);
    return status;
}

void scim_do(const char *method, const char *path, const char *body, long status)
{
    json_t *json = NULL;
    const long got = scim_ask(method, path, body, NULL, &json);

    if (got != status) {
        char *text = json_dumps(json, 0);
        fail_msg("%s %s: %ld: %s", method, path, got, text ? text : "");
    }
    json_decref(json);
}

const char *scim_make(const char *list, const char *body)
{
    static char paths[32][64];
    static unsigned next;
    json_t *json = NULL;

    assert_int_equal(scim_ask("POST", list, body, NULL, &json), 201);
    char *path = paths[next++ % 32];
    (void)snprintf(path, 64, "%s/%s", list, json_string_value(json_object_get(json, "id")));
    json_decref(json);
    return path;
}

const char *scim_text(const char *path, const char *member)
{
    static char text[256];
    json_t *json = NULL;
    char name[128];

    (void)snprintf(name, sizeof name, "%s", member);
    assert_int_equal(scim_ask("GET", path, NULL, NULL, &json), 200);
    const json_t *at = json;
    char *rest = name;
    for (const char *part = strsep(&rest, "/"); part; part = strsep(&rest, "/")) {
        at = json_is_array(at) ? json_array_get(at, (size_t)atoi(part)) : json_object_get(at, part);
    }
    (void)snprintf(text, sizeof text, "%s",
                   json_is_true(at)     ? "true"
                   : json_is_false(at)  ? "false"
                   : json_is_string(at) ? json_string_value(at)
                                        : "");
    if (json_is_integer(at)) {
        (void)snprintf(text, sizeof text, "%lld", (long long)json_integer_value(at));
    }
    json_decref(json);
    return text;
}

struct iso_fleet_id scim_enrol(const char *name, bool mend)
{
    static const uint8_t bytes[2000];
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_person person = {.id = iso_fleet_id_random(),
                                      .enrolled_s = time(NULL),
                                      .name = name,
                                      .name_length = strlen(name),
                                      .credential = "",
                                      .n = 1};
    struct hub_zone lab;
    size_t n = 0;

    person.templates[0] = (struct iso_fleet_template){
        .algorithm = 3, .size = sizeof bytes, .bytes = (uint8_t *)(uintptr_t)bytes};
    served_ok(hub_zone_find(&rig.store, "Lab", &lab, &fault), &fault);
    served_ok(hub_request_add(&rig.store, &gate, &person, &fault), &fault);
    served_ok(hub_request_approve(&rig.store, &person.id, &lab.place.zone, 1, &fault), &fault);
    if (mend) {
        served_ok(hub_directory_mend(&rig.store, HUB_SCIM_SOURCE, &n, &fault), &fault);
    }
    return person.id;
}

const char *scim_zones(const struct iso_fleet_id *id)
{
    static char text[256];
    struct iso_fault fault = {.text = ""};
    struct hub_person person;
    char id_text[ISO_FLEET_ID_TEXT_SIZE];

    text[0] = '\0';
    served_ok(hub_person_find(&rig.store, iso_fleet_id_text(id, id_text), &person, &fault), &fault);
    for (size_t i = 0; i < person.n_zones; i++) {
        const size_t at = strlen(text);
        (void)snprintf(text + at, sizeof text - at, "%s%s", i > 0 ? " " : "", person.zone_names[i]);
    }
    return text;
}

int64_t scim_number(const char *sql)
{
    struct iso_fault fault = {.text = ""};
    PGresult *rows = NULL;

    served_ok(hub_db_run(rig.store.db, sql, NULL, &rows, &fault), &fault);
    const int64_t number = hub_row_integer(rows, 0, 0);
    PQclear(rows);
    return number;
}

void scim_map(const char *group, const char *name)
{
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;

    served_ok(hub_zone_find(&rig.store, name, &zone, &fault), &fault);
    served_ok(hub_scim_zones_set(&rig.store, group, &zone.place.zone, 1, &fault), &fault);
}

const char *scim_ada(void)
{
    return scim_make("Users", "{'schemas':['" SCIM_CORE_USER "'],'userName':'ada@example.org',"
                              "'displayName':'Ada Lovelace','active':true}");
}

void scim_add_member(const char *group, const char *user)
{
    char body[256];

    (void)snprintf(body, sizeof body,
                   SCIM_PATCH
                   "[{'op':'Add','path':'members','value':[{'$ref':null,'value':'%s'}]}]}",
                   user + strlen("Users/"));
    scim_do("PATCH", group, body, 200);
}

bool scim_has(const char *text, const char *part)
{
    return strstr(text, part) != NULL;
}
