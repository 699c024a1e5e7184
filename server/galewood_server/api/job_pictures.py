"""Pictures that a build shows on its way: the tetrahedra, the skeleton."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response

from galewood_server.context import ServiceHere
from galewood_server.http import NOT_MODIFIED, matches, not_found, problems
from galewood_server.jobs import find_job

router = APIRouter(prefix="/api/jobs", tags=["jobs"])


@router.get(
    "/{job_id}/pictures/{name}", response_class=FileResponse, responses={**NOT_MODIFIED, **problems(404)}
)
def get_picture(job_id: str, name: str, request: Request, service: ServiceHere) -> Response:
    """A PNG that the job's `pictures` names; its hash there tells when it changed."""
    with service.sessions() as session:
        sha256 = find_job(session, job_id).pictures.get(name)
    if not sha256 or not service.stores.pictures.has(sha256):
        raise not_found("picture", name)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": "no-cache"}
    if matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return FileResponse(service.stores.pictures.path(sha256), media_type="image/png", headers=headers)
