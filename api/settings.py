"""What whoever runs the service may choose, through environment variables RAYSVC_..."""

import os
import re
from pathlib import Path
from typing import Annotated

from pydantic import Field, ValidationError, field_validator
from pydantic_settings import (
    BaseSettings,
    EnvSettingsSource,
    NoDecode,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
)

from api.limit_settings import LimitSettings
from api.logs import LogFormat, LogLevel
from raysvc.data_folder import default_data_dir
from raysvc.errors import InvalidSetting
from raysvc.jobs import ServiceOptions


class ApiSettings(LimitSettings):
    """Every field is an environment variable: `queue_size` is RAYSVC_QUEUE_SIZE."""

    model_config = SettingsConfigDict(env_prefix="RAYSVC_", frozen=True)

    data_dir: Path = Field(
        default_factory=default_data_dir,
        description="Where scenes, environments, jobs, results and keys are kept; one process owns "
        "it.",
    )
    queue_size: int = Field(
        16, ge=1, le=100_000, description="Jobs that may wait; one more is answered 429."
    )
    kept_jobs: int = Field(
        1_000, ge=1, description="Jobs that are remembered; the oldest finished one goes first."
    )
    idempotency_key_life_s: float = Field(
        86_400.0, gt=0, description="How long an `Idempotency-Key` stands for its job."
    )
    deadline_s: float = Field(
        600.0, gt=0, le=86400, description="Time for a job that does not set `deadline_s`."
    )
    wait_max_s: float = Field(
        60.0, ge=0, le=3600, description="Longest wait that `Prefer: wait` is granted."
    )
    grace_s: float = Field(
        20.0, ge=0, le=3600, description="Time for the running job when the service stops."
    )
    heavy_threads: int = Field(
        2,
        ge=1,
        le=64,
        description="Requests for jobs that are checked, and pictures encoded, at a time.",
    )
    long_threads: int = Field(
        2,
        ge=1,
        le=64,
        description="Environments filtered, and pictures given a lens, at a time; one more is 429.",
    )
    scene_memory_bytes: int = Field(
        1 << 30, ge=0, description="Parsed scenes that are kept in memory."
    )
    environment_memory_bytes: int = Field(
        512 << 20, ge=0, description="Parsed environments that are kept in memory."
    )
    result_memory_bytes: int = Field(
        512 << 20, ge=0, description="Finished pictures that are kept in memory."
    )
    comparison_memory_bytes: int = Field(
        128 << 20, ge=0, description="Finished comparisons that are kept in memory."
    )
    scene_disk_bytes: int = Field(
        8 << 30, ge=0, description="Files of scenes; those not used longest make room."
    )
    environment_disk_bytes: int = Field(
        4 << 30, ge=0, description="Files of environments; those not used longest make room."
    )
    result_disk_bytes: int = Field(
        4 << 30,
        ge=0,
        description="Files of finished pictures and comparisons; those not used longest make room.",
    )
    cors_origins: Annotated[tuple[str, ...], NoDecode] = Field(
        (), description="Origins whose pages may call, commas between; `*` is all of them."
    )
    hosts: Annotated[tuple[str, ...], NoDecode] = Field(
        (),
        description="Names and addresses that the service is called by, commas between; by default "
        "those of this machine if nobody else reaches it, else any.",
    )
    log_format: LogFormat = Field("text", description="`text` for people, `json` for machines.")
    log_level: LogLevel = Field("info", description="`debug`, `info`, `warning` or `error`.")

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Only variables as they are documented, and that are not empty.

        Otherwise `raysvc_data_dir` would count here and nowhere else, and an empty RAYSVC_DATA_DIR
        would be the folder that the service was started in.
        """
        assert isinstance(env_settings, EnvSettingsSource)
        env_settings.env_vars = {
            name.lower(): value for name, value in os.environ.items() if name.isupper() and value
        }
        return init_settings, env_settings

    @field_validator("cors_origins", "hosts", mode="before")
    @classmethod
    def _split(cls, value: object) -> object:
        """Take `A,B` apart."""
        if not isinstance(value, str):
            return value
        return tuple(part.strip() for part in value.split(",") if part.strip())

    @field_validator("cors_origins")
    @classmethod
    def _check_origins(cls, origins: tuple[str, ...]) -> tuple[str, ...]:
        for origin in origins:
            if origin != "*" and not re.fullmatch(r"https?://[^/\s]+", origin):
                raise ValueError(f"{origin!r} is no origin, such as https://example.org")
        return origins

    def service_options(self) -> ServiceOptions:
        """Return what the core's service may use."""
        return ServiceOptions(
            data_dir=self.data_dir,
            queue_size=self.queue_size,
            kept_jobs=self.kept_jobs,
            idempotency_key_life_s=self.idempotency_key_life_s,
            deadline_s=self.deadline_s,
            scene_memory_bytes=self.scene_memory_bytes,
            environment_memory_bytes=self.environment_memory_bytes,
            result_memory_bytes=self.result_memory_bytes,
            comparison_memory_bytes=self.comparison_memory_bytes,
            scene_disk_bytes=self.scene_disk_bytes,
            environment_disk_bytes=self.environment_disk_bytes,
            result_disk_bytes=self.result_disk_bytes,
            parsing=self.parser_options(),
            limits=self.limits(),
        )


def settings_from_environment() -> ApiSettings:
    """Read RAYSVC_... variables. Raises InvalidSetting naming the first that is wrong."""
    try:
        return ApiSettings()
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        name = "RAYSVC_" + "_".join(str(part).upper() for part in fault["loc"])
        given = repr(fault["input"])[:80]
        raise InvalidSetting(f"{fault['msg']} (got {given})", field=name) from None
