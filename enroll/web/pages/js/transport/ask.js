/* Requests to the API of the server from which the pages come. Errors are thrown as a Fault. */

import {Fault} from './fault.js';

export const BASE = '/api/v1';

let loginRequired = () => {};

/* Called when a request is refused because the session has ended. */
export function onLoginRequired(handler) { loginRequired = handler; }

/* The fault of a response that is none of 2xx. */
export async function problem(response, path) {
    let body = {};
    try {
        body = await response.json();
    } catch {
        /* not from the web server: a proxy, for instance */
    }
    const fault = new Fault(body.code ?? `http-${response.status}`, {
        status: response.status,
        detail: body.detail ?? response.statusText,
        setup: body.setup === true,
        retryAfterS: Number(response.headers.get('Retry-After')) || 0,
    });
    if (fault.code === 'login-required' && path !== '/session') {
        loginRequired();
    }
    return fault;
}

export async function open(method, path, body, signal) {
    let response;
    try {
        response = await fetch(BASE + path, {
            method,
            signal,
            credentials: 'same-origin',
            cache: 'no-store',
            headers: body === undefined ? {} : { 'Content-Type': 'application/json' },
            body: body === undefined ? undefined : JSON.stringify(body),
        });
    } catch (error) {
        throw signal?.aborted ? error : new Fault('no-connection', { detail: error.message });
    }
    if (!response.ok) {
        throw await problem(response, path);
    }
    return response;
}

export async function ask(method, path, body) {
    const response = await open(method, path, body);
    return response.status === 204 ? null : response.json();
}

/* A name as a part of a path. */
export const part = (name) => encodeURIComponent(name);

/* The query of a path: members that are undefined or empty are left out. */
export function query(values) {
    const given = Object.entries(values).filter(([, value]) => value !== undefined && value !== '' && value !== false);
    return given.length ? `?${new URLSearchParams(given)}` : '';
}
