/* The API by HTTP: enroll/web/api/openapi.json. transport/cockpit.js has the same functions.
 *
 * Streams: events(on, onState), outline(onRecord, onState) and relief(onRecord, onState) stay open
 * until close() is called, and are opened again after a break; onState(up, fault) says so. */

import {EventParser} from '../stream/event_parser.js';
import {decodeOutline, decodeRelief} from '../stream/record.js';
import {Splitter} from '../stream/splitter.js';
import {steady} from '../stream/steady.js';
import {ask, onLoginRequired, open, part} from './ask.js';
import {upload} from './upload.js';

const SILENT_MS = 30000; /* the server sends a status every ten seconds */

/* Reads a response without an end, and gives up on one that says nothing for a while. */
async function pump(path, signal, silentMs, onBytes) {
    const own = new AbortController();
    const abort = () => own.abort();
    signal.addEventListener('abort', abort, { once: true });
    let timer = setTimeout(abort, silentMs ?? SILENT_MS);
    try {
        const response = await open('GET', path, undefined, own.signal);
        for (const reader = response.body.getReader();;) {
            const { done, value } = await reader.read();
            if (done) {
                return;
            }
            clearTimeout(timer);
            timer = silentMs === null ? 0 : setTimeout(abort, silentMs);
            await onBytes(value);
        }
    } finally {
        clearTimeout(timer);
        signal.removeEventListener('abort', abort);
        own.abort();
    }
}

/* A session that has ended is not tried again by itself: after the login the page opens its streams
 * anew. */
function stopAfterLogout(onState) {
    return (up, fault) => {
        onState(up, fault);
        return fault?.code === 'login-required' ? 'stop' : undefined;
    };
}

function events(on, onState) {
    return steady((signal, alive) => {
        const decoder = new TextDecoder();
        const parser = new EventParser();
        return pump('/events', signal, SILENT_MS, (bytes) => {
            alive();
            for (const { name, data } of parser.push(decoder.decode(bytes, { stream: true }))) {
                let value;
                try {
                    value = JSON.parse(data);
                } catch {
                    continue; /* a broken event is not worth the stream */
                }
                on(name, value);
            }
        });
    }, stopAfterLogout(onState));
}

function records(path, decode, onRecord, onState, endsWith = () => undefined) {
    return steady((signal, alive) => {
        const splitter = new Splitter();
        return pump(path, signal, null, async (bytes) => {
            /* Only the newest record that came is worth drawing. */
            const last = splitter.push(bytes).at(-1);
            const record = last && await decode(last);
            if (record && !signal.aborted) {
                alive();
                onRecord(record);
            }
        });
    }, (up, fault) => stopAfterLogout(onState)(up, fault) ?? endsWith(up, fault));
}

export const http = {
    kind: 'http',
    can: {accounts: true, outline: true, relief: true, settings: true, login: true, update: true},
    onLoginRequired,

    session: () => ask('GET', '/session'),
    login: (account, password) => ask('POST', '/session', {account, password}),
    logout: () => ask('DELETE', '/session'),
    changePassword: (old, fresh) => ask('PUT', '/session/password', {old, new: fresh}),
    setup: (code, account, password) => ask('POST', '/setup', {code, account, password}),

    accounts: async () => (await ask('GET', '/accounts')).accounts ?? [],
    addAccount: (name, password, role) => ask('POST', '/accounts', {name, password, role}),
    changeAccount: (name, change) => ask('PATCH', `/accounts/${part(name)}`, change),
    removeAccount: (name) => ask('DELETE', `/accounts/${part(name)}`),

    status: () => ask('GET', '/status'),
    health: () => ask('GET', '/health'),
    settings: async () => (await ask('GET', '/settings')).settings ?? [],
    setSetting: (section, key, value) => ask('PUT', `/settings/${part(`${section}.${key}`)}`, {value}),
    resetSetting: (section, key) => ask('DELETE', `/settings/${part(`${section}.${key}`)}`),
    setLockdown: (on) => ask('PUT', '/lockdown', {on}),
    clearLockout: () => ask('DELETE', '/lockout'),

    people: () => ask('GET', '/people'),
    changePerson: (name, change) => ask('PATCH', `/people/${part(name)}`, change),
    removePerson: (name) => ask('DELETE', `/people/${part(name)}`),
    credential: (name) => ask('GET', `/people/${part(name)}/credential`),
    changeCredential: (name, patch) => ask('PATCH', `/people/${part(name)}/credential`, patch),

    policy: () => ask('GET', '/policy'),
    storePolicy: (revision, document) => ask('PUT', '/policy', {revision, document}),
    findings: async () => (await ask('GET', '/policy/findings')).findings,
    testAccess: ({person, access_point = '', time, shown = []}) =>
        ask('GET', `/policy/test?${new URLSearchParams({person, access_point, time, shown: shown.join()})}`),

    enrolment: () => ask('GET', '/enrolment'),
    beginEnrolment: (wish) => ask('POST', '/enrolment', wish),
    endEnrolment: () => ask('DELETE', '/enrolment'),

    update: () => ask('GET', '/update'),
    bringUpdate: (file, onSent, signal) => upload('/update', file, onSent, signal),
    restart: () => ask('POST', '/update/restart', {}),

    log: (query) =>
        ask('GET', `/log?${new URLSearchParams(Object.entries(query).filter(([, value]) => value !== undefined))}`),
    verifyLog: () => ask('POST', '/log/verification', {}),

    events,
    outline: (onRecord, onState) => records('/outline', decodeOutline, onRecord, onState),
    relief: (onRecord, onState) => records(
        '/relief', decodeRelief, onRecord, onState,
        (up, fault) => (!up && fault?.code === 'no-enrolment' ? 'stop' : undefined)),
};
