"""Preview images published by a running build: tetrahedra and skeleton."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response

from galewood_server.context import ServiceDep
from galewood_server.http import NOT_MODIFIED, ContentVersion, contents, etag_matches, not_found, problems
from galewood_server.jobs import find_job

router = APIRouter(prefix="/api/jobs", tags=["jobs"])


@router.get(
    "/{job_id}/pictures/{name}",
    response_class=FileResponse,
    responses={**contents("The image.", "image/png"), **NOT_MODIFIED, **problems(404)},
)
def get_picture(
    job_id: str, name: str, request: Request, service: ServiceDep, _version: ContentVersion = ""
) -> Response:
    """A preview image (PNG) listed in the job's `pictures`; its hash there changes with its content."""
    with service.sessions() as session:
        sha256 = find_job(session, job_id).pictures.get(name)
    if not sha256 or not service.stores.pictures.has(sha256):
        raise not_found("picture", name)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": "no-cache"}
    if etag_matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return FileResponse(service.stores.pictures.path(sha256), media_type="image/png", headers=headers)
